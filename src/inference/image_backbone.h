// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "inference/deformable_attention.h"

namespace cdiff::inference {

/// Sizes of an ImageBackbone. Channels are multiples of 16, sides of the image of 16.
struct BackboneSizes {
  std::int64_t image_width = 160;  ///< [px]
  std::int64_t image_height = 96;  ///< [px]
  std::int64_t features = 96;      ///< channels of what comes out

  static constexpr std::array<std::int64_t, 3> kChannels = {32, 64, 128};  ///< of the three stages
  static constexpr std::int64_t kBlocks = 2;                               ///< of each stage
  static constexpr std::int64_t kStride = 8;                               ///< pixels a cell

  MapGrid grid() const { return {image_height / kStride, image_width / kStride}; }
};

/// Features of camera images at stride 8: ResNet-18 (He et al. 2016) of half its width with group
/// normalization (groups of 16 channels), without its last stage, and a feature pyramid of one
/// level (Lin et al. 2017): y = max(0, GN(W_3x3 (up(W_h stage3) + W_l stage2))). Float32, one image
/// after the other, so that an image's features do not depend on others. It reuses its buffers: one
/// object per thread.
class ImageBackbone {
 public:
  ImageBackbone(const BackboneSizes& sizes, const std::map<std::string, Tensor>& tensors);
  ImageBackbone(ImageBackbone&&) noexcept;
  ImageBackbone& operator=(ImageBackbone&&) noexcept;
  ~ImageBackbone();

  /// `rgb`: height x width x 3 bytes; writes a row of features for each cell.
  void encode(const std::uint8_t* rgb, const View& rows);

 private:
  struct Network;
  std::unique_ptr<Network> network_;
};

/// Names and shapes of its tensors: stem.*, layerI.B.*, and pyramid.*, without biases but those of
/// normalizations.
std::vector<TensorShape> backboneTensors(const BackboneSizes& sizes);

}  // namespace cdiff::inference
