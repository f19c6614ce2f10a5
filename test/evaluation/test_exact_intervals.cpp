// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>

#include "evaluation/intervals/intervals.h"

namespace cdiff::evaluation {
namespace {

TEST(PoissonInterval, OfNoEventEndsWhereNoneIsAsRareAsTheTail) {
  // exp(-high) = 0.025.
  const Interval none = poissonInterval(0);
  EXPECT_DOUBLE_EQ(none.low, 0.0);
  EXPECT_NEAR(none.high, -std::log(0.025), 1e-12);
}

TEST(PoissonInterval, OfOneEventSolvesItsTails) {
  // P(X >= 1) = 1 - exp(-low) = 0.025; P(X <= 1) = exp(-high) (1 + high) = 0.025.
  const Interval one = poissonInterval(1);
  EXPECT_NEAR(one.low, -std::log(0.975), 1e-12);
  EXPECT_NEAR(std::exp(-one.high) * (1.0 + one.high), 0.025, 1e-12);
}

TEST(PoissonInterval, OfTenEventsIsThatOfTables) {
  // Garwood's limits of 10 (chi-square tables: 9.591 / 2 and 36.781 / 2).
  const Interval ten = poissonInterval(10);
  EXPECT_NEAR(ten.low, 4.795, 1e-3);
  EXPECT_NEAR(ten.high, 18.390, 1e-3);
}

TEST(BinomialInterval, SolvesItsTails) {
  // 0 of 10: (1 - high)^10 = 0.025; 10 of 10 mirrors it; 1 of 2: 1 - (1 - low)^2 = 0.025.
  EXPECT_DOUBLE_EQ(binomialInterval(0, 10).low, 0.0);
  EXPECT_NEAR(binomialInterval(0, 10).high, 1.0 - std::pow(0.025, 0.1), 1e-12);
  EXPECT_NEAR(binomialInterval(10, 10).low, std::pow(0.025, 0.1), 1e-12);
  EXPECT_DOUBLE_EQ(binomialInterval(10, 10).high, 1.0);
  EXPECT_NEAR(binomialInterval(1, 2).low, 1.0 - std::sqrt(0.975), 1e-12);
}

TEST(LargestShareUnseen, IsNearTheRuleOfThree) {
  EXPECT_NEAR(largestShareUnseen(1), 0.975, 1e-12);
  EXPECT_NEAR(largestShareUnseen(1000), 3.689 / 1000.0, 1e-5);
}

TEST(CompareRates, OfEqualDistancesIsTheSignTest) {
  // 0 against 5 on equal km: p = 2 x 0.5^5; share of B at least 0.025^(1 / 5).
  const RateComparison rates = compareRates(0, 2.0, 5, 2.0);
  EXPECT_NEAR(rates.p, 2.0 / 32.0, 1e-12);
  EXPECT_TRUE(std::isinf(rates.ratio));
  const double share = std::pow(0.025, 0.2);
  EXPECT_NEAR(rates.interval.low, share / (1.0 - share), 1e-9);
  EXPECT_TRUE(std::isinf(rates.interval.high));
}

TEST(CompareRates, TakesDistancesIntoAccount) {
  // A: 1 in 3 km, B: 2 in 1 km: share of B where the rates are equal 1/4; P(X >= 2 of 3) = 3 x 3/64
  // + 1/64 = 10/64; p = 20/64. Ratio 2 / (1/3) = 6.
  const RateComparison rates = compareRates(1, 3.0, 2, 1.0);
  EXPECT_NEAR(rates.p, 20.0 / 64.0, 1e-12);
  EXPECT_NEAR(rates.ratio, 6.0, 1e-12);
  EXPECT_LT(rates.interval.low, 1.0);  // as p > 0.05
}

TEST(CompareRates, WithoutEventsShowsNothing) {
  const RateComparison rates = compareRates(0, 1.0, 0, 1.0);
  EXPECT_DOUBLE_EQ(rates.p, 1.0);
  EXPECT_DOUBLE_EQ(rates.interval.low, 0.0);
  EXPECT_TRUE(std::isinf(rates.interval.high));
}

TEST(HolmAdjusted, StepsDown) {
  // Sorted 0.01, 0.02, 0.04 times 3, 2, 1: 0.03, 0.04, 0.04; a later one is never smaller.
  const std::vector<double> adjusted = holmAdjusted({0.04, 0.01, 0.02});
  EXPECT_NEAR(adjusted[0], 0.04, 1e-15);
  EXPECT_NEAR(adjusted[1], 0.03, 1e-15);
  EXPECT_NEAR(adjusted[2], 0.04, 1e-15);
  EXPECT_NEAR(holmAdjusted({0.01, 0.011})[1], 0.02, 1e-15);  // not 0.011
  EXPECT_DOUBLE_EQ(holmAdjusted({0.9, 0.8}).front(), 1.0);
}

}  // namespace
}  // namespace cdiff::evaluation
