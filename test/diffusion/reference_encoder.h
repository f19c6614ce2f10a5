// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The image encoder of docs/neural_network.md once more, in double precision and without any care
/// for speed; what the fast one is compared with.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "diffusion/model.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::diffusion {

/// A map in plain [channel, row, column] order, double precision.
struct PlainMap {
  std::int64_t channels = 0;
  std::int64_t height = 0;
  std::int64_t width = 0;
  std::vector<double> values;

  PlainMap(std::int64_t c, std::int64_t h, std::int64_t w)
      : channels(c), height(h), width(w), values(static_cast<std::size_t>(c * h * w)) {}
  double& at(std::int64_t c, std::int64_t y, std::int64_t x) {
    return values[static_cast<std::size_t>((c * height + y) * width + x)];
  }
};

/// docs/neural_network.md written down once more, without any care for speed.
class ReferenceEncoder {
 public:
  explicit ReferenceEncoder(const Model& model) : model_(model) {}

  std::vector<double> encode(const traffic::CameraImage& image) const {
    PlainMap map = pool(relu(norm(convolution(read(image), "stem.conv", 2), "stem.norm")));
    const int blocks[] = {3, 4, 6, 3};
    for (int layer = 1; layer <= 4; ++layer) {
      for (int block = 0; block < blocks[layer - 1]; ++block) {
        const std::string name = "layer" + std::to_string(layer) + "." + std::to_string(block);
        map = residualBlock(map, name, layer > 1 && block == 0 ? 2 : 1);
      }
    }
    return project(relu(convolution(map, "squeeze", 1)));
  }

 private:
  const inference::Tensor& tensor(const std::string& name) const { return model_.encoder.at(name); }

  static PlainMap read(const traffic::CameraImage& image) {
    PlainMap map(3, image.height, image.width);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        for (int c = 0; c < 3; ++c) {
          const std::size_t index = static_cast<std::size_t>((y * image.width + x) * 3 + c);
          map.at(c, y, x) = (image.rgb[index] / 255.0 - 0.5) / 0.25;
        }
    return map;
  }

  PlainMap convolution(PlainMap in, const std::string& name, std::int64_t stride) const {
    const inference::Tensor& weight = tensor(name + ".weight");
    const std::int64_t kernel = weight.shape[2];
    const std::int64_t padding = kernel / 2;
    PlainMap out(weight.shape[0], (in.height + 2 * padding - kernel) / stride + 1,
                 (in.width + 2 * padding - kernel) / stride + 1);
    const float* w = weight.values.data();
    for (std::int64_t o = 0; o < out.channels; ++o)
      for (std::int64_t i = 0; i < in.channels; ++i)
        for (std::int64_t dy = -padding; dy <= padding; ++dy)
          for (std::int64_t dx = -padding; dx <= padding; ++dx)
            addTap(in, out, o, i, {dy, dx, stride}, *w++);
    const auto bias = model_.encoder.find(name + ".bias");
    if (bias == model_.encoder.end()) return out;
    for (std::int64_t o = 0; o < out.channels; ++o)
      for (std::int64_t y = 0; y < out.height; ++y)
        for (std::int64_t x = 0; x < out.width; ++x)
          out.at(o, y, x) += bias->second.values[static_cast<std::size_t>(o)];
    return out;
  }

  struct Tap {
    std::int64_t dy;
    std::int64_t dx;
    std::int64_t stride;
  };
  static void addTap(PlainMap& in, PlainMap& out, std::int64_t o, std::int64_t i, const Tap& tap,
                     double weight) {
    for (std::int64_t y = 0; y < out.height; ++y) {
      const std::int64_t from_y = y * tap.stride + tap.dy;
      if (from_y < 0 || from_y >= in.height) continue;
      for (std::int64_t x = 0; x < out.width; ++x) {
        const std::int64_t from_x = x * tap.stride + tap.dx;
        if (from_x < 0 || from_x >= in.width) continue;
        out.at(o, y, x) += weight * in.at(i, from_y, from_x);
      }
    }
  }

  PlainMap norm(PlainMap map, const std::string& name) const {
    const inference::Tensor& gain = tensor(name + ".weight");
    const inference::Tensor& shift = tensor(name + ".bias");
    const std::size_t pixels = static_cast<std::size_t>(map.height * map.width);
    const std::size_t group = 16 * pixels;
    for (std::size_t begin = 0; begin < map.values.size(); begin += group) {
      double mean = 0.0;
      double variance = 0.0;
      for (std::size_t i = begin; i < begin + group; ++i) mean += map.values[i] / group;
      for (std::size_t i = begin; i < begin + group; ++i)
        variance += (map.values[i] - mean) * (map.values[i] - mean) / group;
      for (std::size_t i = begin; i < begin + group; ++i)
        map.values[i] =
            (map.values[i] - mean) / std::sqrt(variance + 1e-5) * gain.values[i / pixels] +
            shift.values[i / pixels];
    }
    return map;
  }

  static PlainMap relu(PlainMap map) {
    for (double& value : map.values) value = std::max(value, 0.0);
    return map;
  }

  static PlainMap pool(PlainMap in) {
    PlainMap out(in.channels, (in.height - 1) / 2 + 1, (in.width - 1) / 2 + 1);
    for (std::int64_t c = 0; c < out.channels; ++c)
      for (std::int64_t y = 0; y < out.height; ++y)
        for (std::int64_t x = 0; x < out.width; ++x) {
          double largest = 0.0;  // as small as anything after a ReLU
          for (std::int64_t v = std::max<std::int64_t>(2 * y - 1, 0);
               v <= std::min(2 * y + 1, in.height - 1); ++v)
            for (std::int64_t u = std::max<std::int64_t>(2 * x - 1, 0);
                 u <= std::min(2 * x + 1, in.width - 1); ++u)
              largest = std::max(largest, in.at(c, v, u));
          out.at(c, y, x) = largest;
        }
    return out;
  }

  PlainMap residualBlock(const PlainMap& in, const std::string& name, std::int64_t stride) const {
    PlainMap map = relu(norm(convolution(in, name + ".conv1", stride), name + ".norm1"));
    map = norm(convolution(map, name + ".conv2", 1), name + ".norm2");
    const bool down = model_.encoder.count(name + ".down.conv.weight") > 0;
    const PlainMap shortcut =
        down ? norm(convolution(in, name + ".down.conv", stride), name + ".down.norm") : in;
    for (std::size_t i = 0; i < map.values.size(); ++i) map.values[i] += shortcut.values[i];
    return relu(map);
  }

  std::vector<double> project(const PlainMap& map) const {
    const inference::Tensor& weight = tensor("project.weight");
    const inference::Tensor& bias = tensor("project.bias");
    std::vector<double> features;
    for (std::size_t o = 0; o < bias.values.size(); ++o) {
      double sum = bias.values[o];
      for (std::size_t i = 0; i < map.values.size(); ++i)
        sum += weight.values[o * map.values.size() + i] * map.values[i];
      features.push_back(sum);
    }
    return features;
  }

  const Model& model_;
};

}  // namespace cdiff::diffusion
