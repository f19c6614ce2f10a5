// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "metrics/formulas/rank_correlation.h"

namespace cdiff::metrics {
namespace {

TEST(RankCorrelation, OfRanks) {
  EXPECT_NEAR(*rankCorrelation({1, 2, 3}, {10, 20, 90}), 1.0, 1e-12);
  EXPECT_NEAR(*rankCorrelation({1, 2, 3}, {3, 2, 1}), -1.0, 1e-12);
  // 1 - 6 sum d^2 / (n (n^2 - 1)) = 1 - 6 x 2 / 60 = 0.8
  EXPECT_NEAR(*rankCorrelation({1, 2, 3, 4}, {10, 20, 40, 30}), 0.8, 1e-12);
}

TEST(RankCorrelation, EqualValuesShareTheirMeanRank) {
  // Ranks 1.5, 1.5, 3 against 1, 2, 3: covariance 1.5, variances 1.5 and 2.
  EXPECT_NEAR(*rankCorrelation({0, 0, 1}, {1, 2, 3}), 1.5 / std::sqrt(3.0), 1e-12);
  // Ranks 1, 2, 3, 4 and 1.5, 1.5, 4, 3: deviations' products 3.5, squares 5 and 4.5.
  EXPECT_NEAR(*rankCorrelation({1, 2, 3, 4}, {5, 5, 8, 7}), 3.5 / std::sqrt(5.0 * 4.5), 1e-12);
  // Ranks 1, 2.5, 2.5, 4 against 1, 2, 3, 4: 4.5 / sqrt(4.5 x 5).
  EXPECT_NEAR(*rankCorrelation({1, 2, 2, 3}, {1, 2, 3, 4}), 4.5 / std::sqrt(4.5 * 5.0), 1e-12);
}

TEST(RankCorrelation, IsUnknownWhereAnOrderIs) {
  EXPECT_FALSE(rankCorrelation({1, 1, 1}, {1, 2, 3}));
  EXPECT_FALSE(rankCorrelation({1, 2, 3}, {4, 4, 4}));
  EXPECT_FALSE(rankCorrelation({1, 2}, {1, 2}));
  EXPECT_FALSE(rankCorrelation({}, {}));
  EXPECT_THROW(rankCorrelation({1}, {1, 2}), std::invalid_argument);
}

}  // namespace
}  // namespace cdiff::metrics
