// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <limits>

#include "metrics/formulas/distributions.h"

namespace cdiff::metrics {
namespace {

std::vector<double> ramp(std::size_t n) {
  std::vector<double> values;
  for (std::size_t i = 0; i < n; ++i) values.push_back(static_cast<double>(i));
  return values;
}

TEST(ShapiroWilk, GivesShapiroAndWilksOwnExample) {
  // Weights of eleven men (Shapiro and Wilk 1965), in any order: W = 0.788815.
  const auto test = shapiroWilk({236, 148, 154, 158, 160, 161, 162, 166, 170, 182, 195});
  EXPECT_NEAR(*test.w, 0.788815, 1e-6);
  EXPECT_TRUE(test.reason.empty());
}

TEST(ShapiroWilk, GivesTheStatisticOfEquallySpacedValues) {
  EXPECT_NEAR(*shapiroWilk(ramp(20)).w, 0.960375, 1e-6);
}

TEST(ShapiroWilk, DoesNotDependOnOriginAndScale) {
  std::vector<double> moved;
  for (const double value : ramp(20)) moved.push_back(1e6 - 1e-3 * value);
  EXPECT_NEAR(*shapiroWilk(moved).w, *shapiroWilk(ramp(20)).w, 1e-9);
}

TEST(ShapiroWilk, IsExactForThreeValues) {
  // a = sqrt(1/2): W = (4 - 1)^2 / 2 / ((16 + 1 + 25) / 9) = 4.5 / (14 / 3) = 27 / 28;
  // p = 6 / pi (asin sqrt(27/28) - asin sqrt(3/4)) = 0.636886.
  const auto test = shapiroWilk({1, 2, 4});
  EXPECT_NEAR(*test.w, 27.0 / 28.0, 1e-12);
  EXPECT_NEAR(*test.p, 0.636886, 1e-6);
}

TEST(ShapiroWilk, NamesTheReasonForItsAbsence) {
  EXPECT_EQ(shapiroWilk({}).reason, "n = 0, needs at least 3");
  EXPECT_EQ(shapiroWilk({1, 2}).reason, "n = 2, needs at least 3");
  EXPECT_EQ(shapiroWilk({5, 5, 5, 5}).reason, "all values are equal");
  EXPECT_EQ(shapiroWilk(ramp(5001)).reason, "n = 5001, defined up to 5000");
  EXPECT_EQ(shapiroWilk({1, 2, std::numeric_limits<double>::quiet_NaN()}).reason,
            "a value is not finite");
  EXPECT_FALSE(shapiroWilk({1, 2}).w.has_value());
  EXPECT_FALSE(shapiroWilk({1, 2}).p.has_value());
  EXPECT_TRUE(shapiroWilk(ramp(5000)).w.has_value());
}

}  // namespace
}  // namespace cdiff::metrics
