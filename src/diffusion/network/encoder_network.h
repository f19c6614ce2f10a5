// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "diffusion/model.h"
#include "inference/encoder_layers.h"

namespace cdiff::diffusion {

/// The layers of the image encoder (docs/neural_network.md) over shared buffers: rgb8 pixels ->
/// features [image_features]. The residual blocks multiply in a precision; first convolution,
/// squeeze and projection in float32.
class EncoderNetwork {
 public:
  /// Throws InputError naming a tensor that is missing or of another shape.
  EncoderNetwork(const Model& model, inference::Precision precision,
                 inference::InstructionSet instruction_set);

  const inference::MapShape& imageShape() const { return image_; }  ///< channels is 3
  /// `rgb` is height x width x 3 bytes.
  std::vector<float> encode(const std::uint8_t* rgb);

 private:
  /// A feature map and what convolutions read of it; blocks share them.
  struct Map {
    float* values = nullptr;
    inference::ConvolutionInput* input = nullptr;
  };
  /// Two convolutions and a shortcut, and the maps between them.
  struct Block {
    inference::EncoderConvolution conv1;
    inference::EncoderNorm norm1;
    inference::EncoderConvolution conv2;
    inference::EncoderNorm norm2;
    std::optional<inference::EncoderConvolution> down;  ///< where size or channels change
    std::optional<inference::EncoderNorm> down_norm;
    Map input;
    Map middle;                 ///< between the convolutions
    float* shortcut = nullptr;  ///< the input, or what `down` makes of it
    Map output;
  };

  void makeStem(const Model& model);
  void makeBlock(const Model& model, const std::string& name, std::int64_t channels,
                 std::int64_t stride);
  void makeProjection(const Model& model);
  /// Of the last layer's output, with padding kernel / 2.
  inference::EncoderConvolution convolution(const Model& model, const std::string& name,
                                            std::int64_t channels, std::int64_t kernel,
                                            std::int64_t stride);
  inference::EncoderNorm norm(const Model& model, const std::string& name,
                              const inference::MapShape& shape) const;
  float* newBuffer(std::int64_t floats);
  Map newMap(std::int64_t size);
  std::int64_t scratchpadFloats() const;
  void bindLayers();
  void bindBlock(Block& block, float* scratchpad);
  void readImage(const std::uint8_t* rgb);
  void runBlock(const Block& block);
  std::vector<float> project() const;

  dnnl::engine engine_;
  dnnl::stream stream_;
  inference::Precision precision_;
  inference::InstructionSet instruction_set_;
  dnnl::memory::format_tag layout_;
  inference::MapShape image_;
  inference::MapShape shape_;  ///< of the last layer that was made
  std::array<float, 256> pixel_values_;
  std::optional<inference::EncoderConvolution> stem_;
  std::optional<inference::EncoderNorm> stem_norm_;
  std::optional<inference::EncoderPooling> pooling_;
  std::vector<Block> blocks_;
  std::optional<inference::EncoderConvolution> squeeze_;
  std::vector<float> projection_;  ///< [channel x row x column, image_features]
  std::vector<float> bias_;        ///< [image_features]
  std::vector<dnnl::memory> buffers_;
  std::vector<std::unique_ptr<inference::ConvolutionInput>> inputs_;
  Map pooled_;
  float* pixels_ = nullptr;    ///< normalized, in imageLayout()
  float* stem_map_ = nullptr;  ///< before pooling
  float* squeezed_ = nullptr;
};

}  // namespace cdiff::diffusion
