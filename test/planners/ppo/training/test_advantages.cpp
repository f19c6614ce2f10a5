// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>

#include "planners/ppo/training/advantages.h"

namespace cdiff::planners {
namespace {

// discount = decay = 0.5. First episode: delta_2 = 2 - 3 = -1 (terminal), A_2 = -1; delta_1 = 1 +
// 0.5 * 3 - 2 = 0.5, A_1 = 0.5 + 0.25 * -1 = 0.25. Second episode, cut: delta = 0 + 0.5 * 4 - 1 =
// 1, and nothing of it reaches the first.
TEST(PpoAdvantages, HandDerived) {
  const std::vector<double> found = ppoAdvantages(
      {{1.0, 2.0, 3.0, false, false}, {2.0, 3.0, 99.0, true, true}, {0.0, 1.0, 4.0, false, true}},
      0.5, 0.5);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_DOUBLE_EQ(found[0], 0.25);
  EXPECT_DOUBLE_EQ(found[1], -1.0);
  EXPECT_DOUBLE_EQ(found[2], 1.0);
}

// Mean 2, variance ((1 + 0 + 1) / 2) = 1.
TEST(PpoAdvantages, Normalized) {
  const std::vector<double> found = ppoNormalized({1.0, 2.0, 3.0});
  EXPECT_NEAR(found[0], -1.0 / 1.00001, 1e-12);
  EXPECT_NEAR(found[1], 0.0, 1e-12);
  EXPECT_NEAR(found[2], 1.0 / 1.00001, 1e-12);
  EXPECT_THROW(ppoNormalized({1.0}), std::invalid_argument);
}

// Means 2 and 6, variances 2 and 8 of two values each: standard error sqrt(2/2 + 8/2) = sqrt(5).
TEST(PpoDifference, IntervalOfTwoMeans) {
  const PpoDifference found = ppoDifference({1.0, 3.0}, {4.0, 8.0});
  EXPECT_DOUBLE_EQ(found.first, 2.0);
  EXPECT_DOUBLE_EQ(found.second, 6.0);
  EXPECT_NEAR(found.low, 4.0 - 1.959963984540054 * std::sqrt(5.0), 1e-12);
  EXPECT_NEAR(found.high, 4.0 + 1.959963984540054 * std::sqrt(5.0), 1e-12);
  EXPECT_THROW(ppoDifference({1.0}, {1.0, 2.0}), std::invalid_argument);
}

}  // namespace
}  // namespace cdiff::planners
