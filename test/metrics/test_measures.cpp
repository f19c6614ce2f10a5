// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <limits>

#include "metrics/formulas/sample_statistics.h"

namespace cdiff::metrics {
namespace {

TEST(TickShare, IsAShareOfTicks) {
  TickShare rate;
  EXPECT_FALSE(rate.measure("none").value.has_value());
  EXPECT_EQ(rate.measure("none").reason, "none");
  for (const bool off : {true, false, false, false}) rate.add(off);
  EXPECT_DOUBLE_EQ(*rate.measure("none").value, 25.0);
  EXPECT_EQ(rate.measure("none").n, 4U);
}

TEST(CollisionsPerKilometer, DividesByTheDistance) {
  // 2 collisions in 500 m: 4 per km.
  const Measure measure = collisionsPerKilometer(2, 500.0, 3);
  EXPECT_DOUBLE_EQ(*measure.value, 4.0);
  EXPECT_EQ(measure.n, 3U);
  EXPECT_DOUBLE_EQ(*collisionsPerKilometer(0, 500.0, 3).value, 0.0);
}

TEST(CollisionsPerKilometer, NamesTheReasonForItsAbsence) {
  EXPECT_EQ(collisionsPerKilometer(0, 0.0, 0).reason, "no CBV was driven");
  EXPECT_EQ(collisionsPerKilometer(1, 0.0, 1).reason, "no CBV moved");
  EXPECT_FALSE(collisionsPerKilometer(1, 0.0, 1).value.has_value());
}

TEST(SampleStatistics, GivesMeanDeviationAndMinimum) {
  SampleStatistics statistics;
  for (const double sample : {4.0, 1.0, 7.0}) statistics.add(sample);
  statistics.add(std::numeric_limits<double>::quiet_NaN());
  statistics.add(std::numeric_limits<double>::infinity());
  // Mean 4, squared differences 0 + 9 + 9, divided by 2: deviation 3.
  const DistributionMeasure measure = statistics.measure("none");
  EXPECT_DOUBLE_EQ(*measure.mean.value, 4.0);
  EXPECT_DOUBLE_EQ(*measure.standard_deviation.value, 3.0);
  EXPECT_DOUBLE_EQ(*measure.minimum.value, 1.0);
  EXPECT_EQ(measure.mean.n, 3U);
  EXPECT_TRUE(measure.mean.reason.empty());
}

TEST(SampleStatistics, NamesTheReasonForAbsence) {
  SampleStatistics statistics;
  EXPECT_EQ(statistics.measure("none").minimum.reason, "none");
  statistics.add(2.0);
  const DistributionMeasure one = statistics.measure("none");
  EXPECT_DOUBLE_EQ(*one.mean.value, 2.0);
  EXPECT_FALSE(one.standard_deviation.value.has_value());
  EXPECT_EQ(one.standard_deviation.reason, "n = 1, needs at least 2");
}

}  // namespace
}  // namespace cdiff::metrics
