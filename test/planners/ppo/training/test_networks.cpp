// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "planners/ppo/training/ppo_networks.h"

namespace cdiff::planners {
namespace {

PpoObservation observationOf(std::uint64_t number) {
  const core::RandomStream random(3, "ppo observations");
  PpoObservation observation;
  for (std::size_t i = 0; i < kPpoInputs; ++i) {
    const double value = random.uniform({number}, static_cast<std::uint32_t>(i), -60.0, 60.0);
    observation[i] = static_cast<float>(value);
  }
  return observation;
}

at::Tensor rowOf(const PpoObservation& observation) {
  return learning::toTensor({observation.begin(), observation.end()}, {1, 24}, at::kCPU);
}

// Actions are of the order of 1; sums of 256 products in float32 agree to some 1e-5 of that.
TEST(PpoNetworks, DrivesAsItWasTrained) {
  PpoNetworks networks(7);
  const PpoActor actor(networks.weights());
  for (std::uint64_t i = 0; i < 100; ++i) {
    const PpoObservation observation = observationOf(i);
    const std::vector<float> trained = learning::toVector(networks.mean(rowOf(observation)));
    const PpoAction driven = actor.mean(observation);
    for (std::size_t k = 0; k < kPpoActions; ++k) EXPECT_NEAR(driven[k], trained[k], 2e-5) << i;
  }
}

// 24 x 256 + 256 + 256 x 256 + 256 + 256 x 2 + 2 + 2, and the same with one output.
TEST(PpoNetworks, HasTheSizesOfRift) {
  PpoNetworks networks(7);
  std::int64_t actor = 0;
  std::int64_t critic = 0;
  for (const at::Tensor& tensor : networks.actor().tensors()) actor += tensor.numel();
  for (const at::Tensor& tensor : networks.critic().tensors()) critic += tensor.numel();
  EXPECT_EQ(actor, 72708);
  EXPECT_EQ(critic, 72449);
  std::map<std::string, std::vector<std::int64_t>> shapes;
  for (const auto& [name, tensor] : networks.weights()) shapes[name] = tensor.shape;
  std::map<std::string, std::vector<std::int64_t>> expected;
  for (const inference::TensorShape& tensor : PpoActor::tensors())
    expected[tensor.name] = tensor.shape;
  EXPECT_EQ(shapes, expected);
}

TEST(PpoNetworks, LastLayersStartOrthogonal) {
  PpoNetworks networks(7);
  const at::Tensor actor = networks.actor()("last.weight");
  const at::Tensor product = at::matmul(actor, actor.t());  // 0.1^2 times the identity
  EXPECT_NEAR(product[0][0].item<double>(), 0.01, 1e-7);
  EXPECT_NEAR(product[1][1].item<double>(), 0.01, 1e-7);
  EXPECT_NEAR(product[0][1].item<double>(), 0.0, 1e-7);
  EXPECT_NEAR(networks.critic()("last.weight").norm().item<double>(), 0.5, 1e-6);
  EXPECT_EQ(learning::toVector(networks.actor()("log_deviation")),
            (std::vector<float>{0.0F, 0.0F}));
}

// With deviations 1 and e^-1 around (0, 1): at (1, 1) the logarithm is -0.5 - log(2 pi) + 1; the
// entropy is 1 + log(2 pi) - 1.
TEST(PpoNetworks, DensityAndEntropyOfTheGaussian) {
  PpoNetworks networks(7);
  PpoActor::Weights weights = networks.weights();
  weights.at("actor.log_deviation").values = {0.0F, -1.0F};
  networks.load(weights, "test");
  const at::Tensor mean = learning::toTensor({0.0F, 1.0F}, {1, 2}, at::kCPU);
  const at::Tensor action = learning::toTensor({1.0F, 1.0F}, {1, 2}, at::kCPU);
  const double circle = std::log(2.0 * core::kPi);
  EXPECT_NEAR(networks.logDensity(mean, action).item<double>(), 0.5 - circle, 1e-6);
  EXPECT_NEAR(networks.entropy().item<double>(), circle, 1e-6);
}

TEST(PpoNetworks, OtherWeightsAreRefused) {
  PpoNetworks networks(7);
  PpoActor::Weights weights = networks.weights();
  weights.erase("critic.last.bias");
  EXPECT_THROW(networks.load(weights, "test"), core::InputError);
}

/// The best of many is what the code takes, whatever else the machine does.
TEST(PpoActor, DecidesWithinATwentiethOfAMillisecond) {
  PpoNetworks networks(7);
  const PpoActor actor(networks.weights());
  double best = 1.0;
  float sum = 0.0F;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const PpoObservation observation = observationOf(i);
    const auto begin = std::chrono::steady_clock::now();
    sum += actor.act(observation)[0];
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    best = std::min(best, seconds.count());
  }
  EXPECT_TRUE(std::isfinite(sum));
  EXPECT_LT(best, 50e-6);
}

}  // namespace
}  // namespace cdiff::planners
