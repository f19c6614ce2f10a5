// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "diffusion/network/image_encoder.h"

#include <stdexcept>
#include <string>

#include "diffusion/network/encoder_network.h"

namespace cdiff::diffusion {

struct ImageEncoder::Network : EncoderNetwork {
  using EncoderNetwork::EncoderNetwork;
};

ImageEncoder::ImageEncoder(const Model& model, inference::Precision precision,
                           inference::InstructionSet instruction_set)
    : network_(std::make_unique<Network>(model, precision, instruction_set)) {}
ImageEncoder::ImageEncoder(ImageEncoder&&) noexcept = default;
ImageEncoder& ImageEncoder::operator=(ImageEncoder&&) noexcept = default;
ImageEncoder::~ImageEncoder() = default;

std::vector<float> ImageEncoder::encode(const traffic::CameraImage& image) {
  const inference::MapShape& expected = network_->imageShape();
  const std::size_t bytes = static_cast<std::size_t>(expected.size());
  if (image.width != expected.width || image.height != expected.height ||
      image.rgb.size() != bytes) {
    throw std::invalid_argument(
        "image encoder: the image is " + std::to_string(image.width) + " x " +
        std::to_string(image.height) + " (" + std::to_string(image.rgb.size()) +
        " bytes), but the model takes " + std::to_string(expected.width) + " x " +
        std::to_string(expected.height) + " (" + std::to_string(bytes) + " bytes)");
  }
  return network_->encode(image.rgb.data());
}

}  // namespace cdiff::diffusion
