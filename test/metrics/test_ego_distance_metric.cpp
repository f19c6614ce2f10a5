// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "metrics/metric_under_test.h"

namespace cdiff::metrics {
namespace {

void drive(test::MetricUnderTest& metric, double x, double y) {
  const traffic::TrafficSnapshot at = test::snapshot(0, {});
  const traffic::Vehicle ego = test::vehicle("ego", traffic::VehicleRole::kEgo, x, y, 1.0);
  MetricTick tick{at};
  tick.ego = &ego;
  metric.observe(tick);
}

TEST(EgoDistance, SumsChords) {
  // (0, 0) to (3, 4) to (3, 10): 5 + 6 m.
  test::MetricUnderTest metric("ego_distance");
  drive(metric, 0.0, 0.0);
  drive(metric, 3.0, 4.0);
  drive(metric, 3.0, 10.0);
  EXPECT_DOUBLE_EQ(*metric.at("ego_distance_m").value, 11.0);
  EXPECT_EQ(metric.at("ego_distance_m").n, 3U);
}

TEST(EgoDistance, DoesNotJumpOverTicksWithoutEgo) {
  test::MetricUnderTest metric("ego_distance");
  drive(metric, 0.0, 0.0);
  metric.observeCbvs({});
  drive(metric, 50.0, 0.0);
  EXPECT_DOUBLE_EQ(*metric.at("ego_distance_m").value, 0.0);
}

TEST(EgoDistance, IsAbsentWithoutEgo) {
  test::MetricUnderTest metric("ego_distance");
  metric.observeCbvs({});
  EXPECT_FALSE(metric.at("ego_distance_m").value.has_value());
}

}  // namespace
}  // namespace cdiff::metrics
