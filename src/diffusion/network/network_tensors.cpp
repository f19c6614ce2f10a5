// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Names and shapes of every tensor of the networks, as docs/network.md names them.
#include "diffusion/network/architecture.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::diffusion {
namespace {

using Size = std::int64_t;

/// Collects tensors in order; layouts are those of libtorch.
class TensorList {
 public:
  void add(const std::string& name, std::vector<Size> shape) {
    tensors_.push_back({name, std::move(shape)});
  }
  void linear(const std::string& name, Size in, Size out) {
    add(name + ".weight", {out, in});
    add(name + ".bias", {out});
  }
  void convolution(const std::string& name, Size in, Size out, Size kernel) {
    add(name + ".weight", {out, in, kernel});
    add(name + ".bias", {out});
  }
  void transposedConvolution(const std::string& name, Size in, Size out, Size kernel) {
    add(name + ".weight", {in, out, kernel});
    add(name + ".bias", {out});
  }
  /// Without bias.
  void imageConvolution(const std::string& name, Size in, Size out, Size kernel) {
    add(name + ".weight", {out, in, kernel, kernel});
  }
  void norm(const std::string& name, Size channels) {
    add(name + ".weight", {channels});
    add(name + ".bias", {channels});
  }
  std::vector<inference::TensorShape> take() { return std::move(tensors_); }

 private:
  std::vector<inference::TensorShape> tensors_;
};

void addConditioning(TensorList& list, const Architecture& a) {
  if (a.takesRoute()) {
    list.linear("route.0", 2 * a.route_points, 2 * a.route_features);
    list.linear("route.2", 2 * a.route_features, a.route_features);
    list.add("no_route", {a.route_features});
  }
  if (a.takesSpeed()) list.linear("speed.0", 1, a.speed_features);
  if (a.takesPrevious()) list.add("no_previous", {a.image_features});
  if (a.takesTarget()) {
    list.linear("target.0", 1, a.target_features);
    list.add("no_target", {a.target_features});
  }
  if (a.context_width > 0) list.linear("context.0", a.joinedFeatures(), a.context_width);
  list.linear("time.0", a.time_width, 4 * a.time_width);
  list.linear("time.2", 4 * a.time_width, a.time_width);
}

void addResidualBlock(TensorList& list, const Architecture& a, const std::string& name, Size in,
                      Size out) {
  list.convolution(name + ".block1.conv", in, out, a.kernel);
  list.norm(name + ".block1.norm", out);
  list.linear(name + ".inject", a.time_width + a.contextValues(), out);
  list.convolution(name + ".block2.conv", out, out, a.kernel);
  list.norm(name + ".block2.norm", out);
  if (in != out) list.convolution(name + ".skip", in, out, 1);
}

void addBlockPair(TensorList& list, const Architecture& a, const std::string& name, Size in,
                  Size out) {
  addResidualBlock(list, a, name + ".a", in, out);
  addResidualBlock(list, a, name + ".b", out, out);
}

void addUNet(TensorList& list, const Architecture& a) {
  const std::size_t levels = a.channels.size();
  Size in = traffic::kRolloutColumns;
  for (std::size_t level = 0; level < levels; ++level) {
    const std::string name = "down." + std::to_string(level);
    const Size out = a.channels[level];
    addBlockPair(list, a, name, in, out);
    if (level + 1 < levels) list.convolution(name + ".sample", out, out, 3);
    in = out;
  }
  addBlockPair(list, a, "middle", in, in);
  for (std::size_t step = 0; step + 1 < levels; ++step) {
    const std::string name = "up." + std::to_string(step);
    const Size out = a.channels[levels - 2 - step];
    addBlockPair(list, a, name, 2 * a.channels[levels - 1 - step], out);
    list.transposedConvolution(name + ".sample", out, out, 4);
  }
  const Size width = a.channels.front();
  list.convolution("head.block.conv", width, width, a.kernel);
  list.norm("head.block.norm", width);
  list.convolution("head.out", width, traffic::kActionColumns, 1);
}

void addStateHead(TensorList& list, const Architecture& a) {
  const Size speed = a.takesSpeed() ? 1 : 0;
  list.linear("state.0", a.horizon * traffic::kActionColumns + speed + a.time_width,
              a.state_hidden);
  list.linear("state.2", a.state_hidden, a.state_hidden);
  list.linear("state.4", a.state_hidden, a.horizon * traffic::kStateColumns);
}

void addBasicBlock(TensorList& list, const std::string& name, Size in, Size out) {
  list.imageConvolution(name + ".conv1", in, out, 3);
  list.norm(name + ".norm1", out);
  list.imageConvolution(name + ".conv2", out, out, 3);
  list.norm(name + ".norm2", out);
  if (in == out) return;
  list.imageConvolution(name + ".down.conv", in, out, 1);
  list.norm(name + ".down.norm", out);
}

/// Size of the last feature map: five layers of stride 2, each rounding up.
Size afterStrides(Size pixels) {
  for (int i = 0; i < 5; ++i) pixels = (pixels + 1) / 2;
  return pixels;
}

}  // namespace

std::vector<inference::TensorShape> denoiserTensors(const Architecture& architecture) {
  TensorList list;
  addConditioning(list, architecture);
  addUNet(list, architecture);
  addStateHead(list, architecture);
  return list.take();
}

std::vector<inference::TensorShape> encoderTensors(const Architecture& architecture) {
  constexpr Size kStemChannels = 64;
  constexpr Size kSqueezeChannels = 64;
  constexpr int kBlocks[] = {3, 4, 6, 3};
  TensorList list;
  list.imageConvolution("stem.conv", 3, kStemChannels, 7);
  list.norm("stem.norm", kStemChannels);
  Size in = kStemChannels;
  for (int layer = 0; layer < 4; ++layer) {
    const Size out = kStemChannels << layer;
    for (int block = 0; block < kBlocks[layer]; ++block) {
      addBasicBlock(list, "layer" + std::to_string(layer + 1) + "." + std::to_string(block), in,
                    out);
      in = out;
    }
  }
  list.add("squeeze.weight", {kSqueezeChannels, in, 1, 1});
  list.add("squeeze.bias", {kSqueezeChannels});
  list.linear("project",
              kSqueezeChannels * afterStrides(architecture.image_height) *
                  afterStrides(architecture.image_width),
              architecture.image_features);
  return list.take();
}

}  // namespace cdiff::diffusion
