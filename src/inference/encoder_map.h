// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Feature maps of one image in oneDNN memory, float32, [1, channels, height, width] stored
/// channels last or in blocks of 8 or 16 channels, whichever this machine's convolutions work best
/// on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <oneapi/dnnl/dnnl.hpp>

namespace cdiff::inference {

struct MapShape {
  std::int64_t channels = 0;
  std::int64_t height = 0;
  std::int64_t width = 0;

  std::int64_t pixels() const { return height * width; }
  std::int64_t size() const { return channels * pixels(); }
};

/// Layout that a 3x3 convolution prefers here: nhwc, nChw8c or nChw16c.
dnnl::memory::format_tag preferredLayout(const dnnl::engine& engine);

/// The plain layout in which the first convolution reads the image's three channels.
dnnl::memory::format_tag imageLayout(dnnl::memory::format_tag layout);

dnnl::memory::desc mapDescription(const MapShape& shape, dnnl::memory::format_tag layout);

/// Where channel c of a pixel lies: block (c / width) x block_stride + pixel x pixel_stride + c %
/// width, in floats; only the strides depend on the layout.
struct ChannelBlocks {
  std::int64_t width = 16;  ///< channels side by side: 8 or 16
  std::int64_t block_stride = 0;
  std::int64_t pixel_stride = 0;

  ChannelBlocks(const MapShape& shape, dnnl::memory::format_tag layout);
};

/// While one lives, oneDNN computes on the calling thread alone.
class OneThread {
 public:
  OneThread();
  ~OneThread();
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int before_;
};

}  // namespace cdiff::inference
