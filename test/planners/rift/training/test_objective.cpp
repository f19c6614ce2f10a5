// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>

#include "learning/parameters.h"
#include "planners/rift/training/rift_groups.h"
#include "planners/rift/training/rift_objective.h"

namespace cdiff::planners {
namespace {

at::Tensor row(const std::vector<float>& values) {
  return learning::toTensor(values, {1, static_cast<std::int64_t>(values.size())}, at::kCPU);
}

/// Logits of given probabilities.
std::vector<float> logitsOf(const std::vector<double>& probabilities) {
  std::vector<float> logits;
  for (const double p : probabilities) logits.push_back(static_cast<float>(std::log(p)));
  return logits;
}

/// Two candidates.
RiftRows twoOf(double p, double old, const std::vector<float>& advantages) {
  RiftRows rows;
  rows.logits = row(logitsOf({p, 1.0 - p}));
  rows.old_logits = row(logitsOf({old, 1.0 - old}));
  rows.first_logits = row(logitsOf({0.5, 0.5}));
  rows.advantages = row(advantages);
  rows.mask = row({0.0F, 0.0F});
  return rows;
}

// Mean 2, deviation sqrt(2 / 3) = 0.8164966.
TEST(RiftObjective, AdvantagesAreReturnsInDeviationsFromTheMean) {
  const auto advantages = groupAdvantages({1.0, 2.0, 3.0});
  EXPECT_NEAR(advantages[0], -1.0 / 0.8165066, 1e-6);
  EXPECT_NEAR(advantages[1], 0.0, 1e-12);
  EXPECT_NEAR(advantages[2], 1.0 / 0.8165066, 1e-6);
  for (const double value : groupAdvantages({5.0, 5.0})) EXPECT_EQ(value, 0.0);
}

// Ratios 0.6 / 0.5 = 1.2 and 0.4 / 0.5 = 0.8, at the limits: -(1.2 x 1 + 0.8 x (-1)) / 2 = -0.2.
TEST(RiftObjective, IsTheMeanOfRatioTimesAdvantage) {
  EXPECT_NEAR(riftLoss({}, twoOf(0.6, 0.5, {1.0F, -1.0F})).item<double>(), -0.2, 1e-6);
}

// Ratios 1.8 and 0.2: min(1.8, 1.2) = 1.2 and min(-0.2, -0.8) = -0.8: the same, without gradient.
TEST(RiftObjective, IsClipped) {
  RiftRows rows = twoOf(0.9, 0.5, {1.0F, -1.0F});
  rows.logits.set_requires_grad(true);
  const at::Tensor loss = riftLoss({}, rows);
  EXPECT_NEAR(loss.item<double>(), -0.2, 1e-6);
  loss.backward();
  EXPECT_NEAR(rows.logits.grad().abs().max().item<double>(), 0.0, 1e-7);
}

// Ratio 0.9 / 0.1 = 9 with A = -1: min(-9, -1.2) = -9, floored at 3 A = -3; the other, ratio 1/9
// with A = 1: min(0.111, 0.8) = 0.111. -( -3 + 0.1111) / 2 = 1.4444; without the floor 4.4444.
TEST(RiftObjective, NegativeAdvantagesAreFloored) {
  const RiftRows rows = twoOf(0.9, 0.1, {-1.0F, 1.0F});
  EXPECT_NEAR(riftLoss({}, rows).item<double>(), 1.4444444, 1e-5);
  EXPECT_NEAR(riftLoss({0.2, 0.0, 0.0}, rows).item<double>(), 4.4444444, 1e-5);
}

// KL(0.5, 0.5 || 0.9, 0.1) = 0.5 ln(0.5 / 0.9) + 0.5 ln(0.5 / 0.1) = 0.5108256, its mean over two
// candidates half of that; weight 0.2. Advantages 0 leave nothing else.
TEST(RiftObjective, DivergenceFromTheReferenceIsAdded) {
  const RiftRows rows = twoOf(0.9, 0.9, {0.0F, 0.0F});
  EXPECT_NEAR(riftLoss({0.2, 0.0, 0.2}, rows).item<double>(), 0.2 * 0.5 * 0.5108256, 1e-6);
}

TEST(RiftObjective, PaddingCountsForNothing) {
  RiftRows rows;
  rows.logits = row({std::log(0.6F), std::log(0.4F), 5.0F});
  rows.old_logits = row({std::log(0.5F), std::log(0.5F), -5.0F});
  rows.first_logits = rows.old_logits;
  rows.advantages = row({1.0F, -1.0F, 7.0F});
  rows.mask = row({0.0F, 0.0F, -1e9F});
  EXPECT_NEAR(riftLoss({}, rows).item<double>(), -0.2, 1e-6);
  EXPECT_TRUE(std::isfinite(riftLoss({0.2, 0.0, 0.2}, rows).item<double>()));
}

TEST(RiftObjective, ItsGradientRaisesTheBetterCandidate) {
  RiftRows rows = twoOf(0.5, 0.5, {1.0F, -1.0F});
  rows.logits.set_requires_grad(true);
  riftLoss({}, rows).backward();
  EXPECT_LT(rows.logits.grad()[0][0].item<double>(), 0.0) << "falls with the first logit";
  EXPECT_GT(rows.logits.grad()[0][1].item<double>(), 0.0);
}

}  // namespace
}  // namespace cdiff::planners
