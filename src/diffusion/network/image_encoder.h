// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <vector>

#include "diffusion/model.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "inference/precision.h"

namespace cdiff::diffusion {

/// The image encoder: ResNet-34 with group normalization and a projection, rgb8 image -> features
/// (architecture.image_features). One image at a time, so that an image's features do not depend on
/// its neighbors. It reuses its buffers: one object per thread.
class ImageEncoder {
 public:
  /// Throws InputError naming a tensor that is missing or of another shape. A processor without the
  /// instructions of `precision`: see precisionNamed.
  explicit ImageEncoder(
      const Model& model, inference::Precision precision = inference::Precision::kFp32,
      inference::InstructionSet instruction_set = inference::bestInstructionSet());
  ImageEncoder(ImageEncoder&&) noexcept;
  ImageEncoder& operator=(ImageEncoder&&) noexcept;
  ~ImageEncoder();

  /// Throws std::invalid_argument for an image of another size.
  std::vector<float> encode(const traffic::CameraImage& image);

 private:
  struct Network;
  std::unique_ptr<Network> network_;
};

}  // namespace cdiff::diffusion
