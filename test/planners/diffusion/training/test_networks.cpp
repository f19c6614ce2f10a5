// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <map>

#include "learning/layers.h"
#include "learning/small_samples.h"
#include "planners/diffusion/training/networks.h"

namespace cdiff::planners {
namespace {

using learning::ParameterSet;
using learning::toTensor;
using learning::toVector;

using Shapes = std::map<std::string, std::vector<std::int64_t>>;

Shapes shapesOf(const ParameterSet& parameters) {
  Shapes shapes;
  for (const std::string& name : parameters.names()) shapes[name] = parameters(name).sizes().vec();
  return shapes;
}

Shapes shapesOf(const std::vector<inference::TensorShape>& tensors) {
  Shapes shapes;
  for (const inference::TensorShape& tensor : tensors) shapes[tensor.name] = tensor.shape;
  return shapes;
}

/// Two vehicles with features, the second without route.
ContextBatch contextOf(const diffusion::Architecture& architecture) {
  const auto ramp = [](std::int64_t columns) {
    return at::linspace(-1.0, 1.0, 2 * columns).view({2, columns});
  };
  return {ramp(architecture.image_features),
          ramp(2 * architecture.route_points),
          toTensor({1.0F, 0.0F}, {2, 1}, at::kCPU),
          toTensor({0.5F, 1.2F}, {2, 1}, at::kCPU),
          {},
          {},
          {},
          {}};
}

bool belongsToStates(const std::string& name) {
  return name.rfind("state.", 0) == 0 || name.rfind("time.", 0) == 0;
}

TEST(Networks, TensorsAreThoseOfTheWeightFiles) {
  for (const auto& architecture : {diffusion::Architecture{}, test::smallArchitecture()}) {
    EXPECT_EQ(shapesOf(DenoiserNet(architecture, 1).parameters()),
              shapesOf(diffusion::denoiserTensors(architecture)));
    EXPECT_EQ(shapesOf(ImageEncoderNet(architecture, 1).parameters()),
              shapesOf(diffusion::encoderTensors(architecture)));
  }
}

TEST(Networks, StateLossLeavesTheActionHeadUntouched) {
  const diffusion::Architecture architecture = test::smallArchitecture();
  DenoiserNet denoiser(architecture, 1);
  denoiser.parameters().setTrained(true);
  const ContextBatch context = contextOf(architecture);
  const at::Tensor noisy = at::linspace(-2.0, 2.0, 2 * 8 * 7).view({2, 8, 7});
  const at::Tensor k = at::full({2}, 3, at::kLong);
  const at::Tensor actions = denoiser.predictActions(noisy, k, context);
  denoiser.predictStates(actions, k, context, true).pow(2).sum().backward();
  for (const std::string& name : denoiser.parameters().names()) {
    const at::Tensor gradient = denoiser.parameters()(name).grad();
    const bool moved = gradient.defined() && gradient.abs().sum().item<double>() > 0.0;
    EXPECT_EQ(moved, belongsToStates(name)) << name;
  }
}

TEST(Networks, GradientReachesTheActionsWhenNotDetached) {
  const diffusion::Architecture architecture = test::smallArchitecture();
  const DenoiserNet denoiser(architecture, 1);
  const ContextBatch context = contextOf(architecture);
  at::Tensor actions = at::linspace(-1.0, 1.0, 2 * 8 * 3).view({2, 8, 3});
  actions.set_requires_grad(true);
  const at::Tensor k = at::full({2}, 3, at::kLong);
  denoiser.predictStates(actions, k, context, false).sum().backward();
  EXPECT_GT(actions.grad().abs().sum().item<double>(), 0.0);
}

TEST(Networks, RouteMattersOnlyWhereThereIsOne) {
  const diffusion::Architecture architecture = test::smallArchitecture();
  const DenoiserNet denoiser(architecture, 1);
  const at::Tensor noisy = at::linspace(-2.0, 2.0, 2 * 8 * 7).view({2, 8, 7});
  const at::Tensor k = at::full({2}, 3, at::kLong);
  ContextBatch context = contextOf(architecture);
  const at::Tensor before = denoiser.predictActions(noisy, k, context);
  context.route = context.route + 1.0;
  const at::Tensor after = denoiser.predictActions(noisy, k, context);
  EXPECT_FALSE(at::equal(before[0], after[0]));
  EXPECT_TRUE(at::equal(before[1], after[1]));
}

TEST(Networks, EncoderTakesHalfSizeImages) {
  const diffusion::Architecture architecture = test::smallArchitecture();
  const ImageEncoderNet encoder(architecture, 1);
  for (const std::int64_t size : {64, 32}) {
    const at::Tensor images = at::linspace(-2.0, 2.0, 3 * size * size).view({1, 3, size, size});
    const at::Tensor features = encoder.forward(images);
    EXPECT_EQ(features.sizes(), at::IntArrayRef({1, architecture.image_features}));
    EXPECT_TRUE(at::isfinite(features).all().item<bool>());
  }
}

TEST(Networks, HalfPrecisionChangesFeaturesLittle) {
  // bfloat16 keeps 8 bits: a relative error of a few times 2^-8 of the features' size is expected.
  const diffusion::Architecture architecture = test::smallArchitecture();
  ImageEncoderNet encoder(architecture, 1);
  const at::Tensor images = at::linspace(-2.0, 2.0, 3 * 64 * 64).view({1, 3, 64, 64}).sin();
  const at::Tensor full = encoder.forward(images);
  encoder.setHalfPrecision(true);
  const at::Tensor half = encoder.forward(images);
  const double error = (half - full).norm().item<double>() / full.norm().item<double>();
  EXPECT_GT(error, 0.0);
  EXPECT_LT(error, 0.03);
}

TEST(Networks, DoublingIsTheTransposedConvolution) {
  const diffusion::Architecture architecture = test::smallArchitecture();
  const DenoiserNet denoiser(architecture, 1);
  const at::Tensor x = at::linspace(-1.0, 1.0, 2 * 16 * 4).view({2, 16, 4});
  const at::Tensor expected = at::conv_transpose1d(x, denoiser.parameters()("up.0.sample.weight"),
                                                   denoiser.parameters()("up.0.sample.bias"), 2, 1);
  EXPECT_TRUE(at::allclose(denoiser.doubled("up.0.sample", x), expected, 1e-5, 1e-6));
}

TEST(Networks, LinearLayerIsAMatrixProduct) {
  // y = W x + b with W = [[1, 2], [3, 4], [5, 6]], b = [0, 10, 20] and x = [1, -1]:
  // (1 - 2, 3 - 4 + 10, 5 - 6 + 20) = (-1, 9, 19).
  ParameterSet parameters(core::RandomStream(1, "test"));
  parameters.declareLayer("layer", {3, 2});
  parameters.load(
      {{"layer.weight", {{3, 2}, {1, 2, 3, 4, 5, 6}}}, {"layer.bias", {{3}, {0, 10, 20}}}}, "test");
  const at::Tensor x = toTensor({1.0F, -1.0F}, {1, 2}, at::kCPU);
  EXPECT_EQ(toVector(linear(parameters, "layer", x)), (std::vector<float>{-1, 9, 19}));
}

}  // namespace
}  // namespace cdiff::planners
