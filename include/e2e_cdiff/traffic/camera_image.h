// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <vector>

namespace cdiff::traffic {

/// What a camera saw: rgb8, row-major from the top left, `height` x `width` x 3 bytes.
struct CameraImage {
  int width = 0;
  int height = 0;
  std::uint64_t tick = 0;         ///< tick of the snapshot that it shows
  std::vector<std::uint8_t> rgb;  ///< height x width x 3

  bool empty() const { return rgb.empty(); }
};

}  // namespace cdiff::traffic
