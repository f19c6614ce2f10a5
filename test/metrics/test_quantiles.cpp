// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "metrics/formulas/quantiles.h"

namespace cdiff::metrics {
namespace {

TEST(QuantileOf, IsLinearBetweenOrderStatistics) {
  // numpy.quantile([4, 1, 3, 2], [0.05, 0.5, 1]) = [1.15, 2.5, 4].
  EXPECT_NEAR(quantileOf({1, 2, 3, 4}, 0.05, QuantileRule::kLinear), 1.15, 1e-12);
  EXPECT_NEAR(quantileOf({1, 2, 3, 4}, 0.5, QuantileRule::kLinear), 2.5, 1e-12);
  EXPECT_EQ(quantileOf({1, 2, 3, 4}, 1.0, QuantileRule::kLinear), 4.0);
  EXPECT_EQ(quantileOf({7}, 0.05, QuantileRule::kLinear), 7.0);
}

TEST(QuantileOf, OfTheNearestRankIsOneOfTheValuesAndReachesBothEnds) {
  // ceil(0.5 * 4) = 2, ceil(0.51 * 4) = 3.
  EXPECT_EQ(quantileOf({1, 2, 3, 4}, 0.5, QuantileRule::kNearestRank), 2.0);
  EXPECT_EQ(quantileOf({1, 2, 3, 4}, 0.51, QuantileRule::kNearestRank), 3.0);
  EXPECT_EQ(quantileOf({1, 2, 3}, 0.0, QuantileRule::kNearestRank), 1.0);
  EXPECT_EQ(quantileOf({1, 2, 3}, 1.0, QuantileRule::kNearestRank), 3.0);
}

TEST(QuantileOf, NearestToLinearRoundsThePlace) {
  // 0.45 * 3 = 1.35 -> index 1, 0.55 * 3 = 1.65 -> index 2.
  EXPECT_EQ(quantileOf({1, 2, 3, 4}, 0.45, QuantileRule::kNearestToLinear), 2.0);
  EXPECT_EQ(quantileOf({1, 2, 3, 4}, 0.55, QuantileRule::kNearestToLinear), 3.0);
}

// m = 4: t(0.975; 3) = 3.18245, times sqrt(4 / 3) = 3.67477, Phi(-3.67477) = 1.190e-4. With many
// clusters it is the 2.5 % of a plain interval.
TEST(ExpandedTail, ShrinksWithFewClusters) {
  EXPECT_NEAR(expandedTail(4), 1.190e-4, 1e-7);
  EXPECT_NEAR(expandedTail(100000), 0.025, 1e-5);
}

}  // namespace
}  // namespace cdiff::metrics
