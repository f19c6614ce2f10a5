// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "learning/parameters.h"

namespace cdiff::learning {
namespace {

// Gradients (3, 4) and (0, 12) have norms 5 and 12, together 13. Clipped at 6 by themselves the
// first is left alone and the second becomes 6.
TEST(Optimizer, ClipsSomeOfTheParameters) {
  std::vector<at::Tensor> weights = {at::zeros({2}), at::zeros({2})};
  for (at::Tensor& weight : weights) weight.set_requires_grad(true);
  Optimizer optimizer(weights, {});
  const at::Tensor factors = toTensor({3.0F, 4.0F, 0.0F, 12.0F}, {2, 2}, at::kCPU);
  (weights[0] * factors[0] + weights[1] * factors[1]).sum().backward();
  EXPECT_NEAR(optimizer.clipGradients(100.0), 13.0, 1e-5);
  EXPECT_NEAR(optimizer.clipGradients(6.0, 0, 1), 5.0, 1e-6);
  EXPECT_NEAR(optimizer.clipGradients(6.0, 1, 1), 12.0, 1e-5);
  EXPECT_NEAR(weights[0].grad().norm().item<double>(), 5.0, 1e-5);
  EXPECT_NEAR(weights[1].grad().norm().item<double>(), 6.0, 1e-5);
}

// First step with epsilon 1 and gradients 2 and -3: w = 1 - 0.1 g / (|g| + 1).
TEST(Optimizer, EpsilonDampsSmallGradients) {
  at::Tensor weight = at::ones({2});
  weight.set_requires_grad(true);
  Optimizer optimizer({weight}, {0.0, 0.0, 0.999, 1.0});
  (weight * toTensor({2.0F, -3.0F}, {2}, at::kCPU)).sum().backward();
  optimizer.step(0, 0.1);
  EXPECT_NEAR(toVector(weight)[0], 1.0F - 0.1F * 2.0F / 3.0F, 1e-6F);
  EXPECT_NEAR(toVector(weight)[1], 1.0F + 0.1F * 3.0F / 4.0F, 1e-6F);
}

TEST(Optimizer, FirstStepMovesByTheRate) {
  // m' = g and v' = g^2 after the first step: w = 1 - 0.1 sign(g), without decay for one dimension;
  // the average takes 1 - 1/10 of the way: 1 + 0.9 (w - 1).
  at::Tensor weight = at::ones({2});
  weight.set_requires_grad(true);
  Optimizer optimizer({weight}, {0.5, 0.999});
  (weight * toTensor({2.0F, -3.0F}, {2}, at::kCPU)).sum().backward();
  EXPECT_NEAR(optimizer.clipGradients(1e9), std::sqrt(13.0), 1e-5);
  optimizer.step(0, 0.1);
  const std::vector<float> moved = toVector(weight);
  EXPECT_NEAR(moved[0], 0.9F, 1e-6F);
  EXPECT_NEAR(moved[1], 1.1F, 1e-6F);
  optimizer.swapAverage();
  EXPECT_NEAR(toVector(weight)[0], 0.91F, 1e-6F);
}

}  // namespace
}  // namespace cdiff::learning
