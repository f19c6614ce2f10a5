// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <limits>

#include "metrics/formulas/distributions.h"

namespace cdiff::metrics {
namespace {

TEST(WassersteinDistance, IsTheMeanShiftOfEqualSizes) {
  // Sorted pairs (1, 2), (3, 4), (5, 9): (1 + 1 + 4) / 3 = 2.
  EXPECT_NEAR(*wassersteinDistance({5, 1, 3}, {9, 2, 4}), 2.0, 1e-12);
  EXPECT_EQ(wassersteinDistance({1, 1, 4}, {4, 1, 1}), 0.0);
}

TEST(WassersteinDistance, TakesDifferentSizes) {
  // A quarter of the mass moves by 1 from 1 to 0, another by 1 from 1 to 2: 0.5.
  EXPECT_NEAR(*wassersteinDistance({1, 1}, {0, 1, 1, 2}), 0.5, 1e-12);
  // One value against two: |7 - 4| / 2 + |7 - 8| / 2 = 2.
  EXPECT_NEAR(*wassersteinDistance({7}, {4, 8}), 2.0, 1e-12);
}

TEST(WassersteinDistance, IsSymmetric) {
  EXPECT_NEAR(*wassersteinDistance({0, 1, 5}, {2, 3}), *wassersteinDistance({2, 3}, {0, 1, 5}),
              1e-12);
}

TEST(WassersteinDistance, IsAbsentWithoutASampleOrWithNan) {
  EXPECT_FALSE(wassersteinDistance({}, {1}).has_value());
  EXPECT_FALSE(wassersteinDistance({1}, {}).has_value());
  EXPECT_FALSE(wassersteinDistance({1}, {std::numeric_limits<double>::quiet_NaN()}).has_value());
}

}  // namespace
}  // namespace cdiff::metrics
