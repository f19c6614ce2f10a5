// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// What metrics report of their samples beside the mean.
#include <gtest/gtest.h>

#include <cmath>

#include "metrics/metric_under_test.h"

namespace cdiff::metrics {
namespace {

// Speeds 2, 4, 9: mean 5, squares of differences 9 + 1 + 16 over n - 1 = 2. Accelerations -3, 1, 2,
// straight on: magnitudes 3, 1, 2, mean 2, squares of differences 1 + 1 + 0.
TEST(CbvMotionMetric, ReportsMeanDeviationAndMinimum) {
  test::MetricUnderTest motion("cbv_motion");
  for (const auto& [speed, acceleration] : {std::pair{2.0, -3.0}, {4.0, 1.0}, {9.0, 2.0}}) {
    traffic::Vehicle vehicle = test::cbv("a", 0, 0, speed);
    vehicle.acceleration = acceleration;
    motion.observeCbvs({{&vehicle}});
  }
  EXPECT_DOUBLE_EQ(*motion.at("cbv_speed_mean_mps").value, 5.0);
  EXPECT_DOUBLE_EQ(*motion.at("cbv_speed_std_mps").value, std::sqrt(13.0));
  EXPECT_DOUBLE_EQ(*motion.at("cbv_speed_min_mps").value, 2.0);
  EXPECT_DOUBLE_EQ(*motion.at("cbv_acceleration_mean_mps2").value, 2.0);
  EXPECT_DOUBLE_EQ(*motion.at("cbv_acceleration_std_mps2").value, 1.0);
  EXPECT_DOUBLE_EQ(*motion.at("cbv_acceleration_min_mps2").value, 1.0);
}

/// A metric of the ego's times to collision after decisions at which they are 2, 1 and 4.5 s, and
/// one without any.
test::MetricUnderTest shownTimes(const std::string& metric) {
  test::MetricUnderTest times(metric);
  const traffic::TrafficSnapshot snapshot = test::snapshot(0, {test::ego(0, 0, 5)});
  const traffic::Vehicle cbv = test::cbv("a", 0, 0, 5);
  MetricTick tick{snapshot, nullptr, snapshot.ego()};
  tick.cbvs.push_back({&cbv});
  for (const double seconds : {2.0, 1.0, 4.5}) {
    Interaction& found = tick.interaction;
    found.ttc_2d = found.ttc_2d_cbv = found.ttc_lon_lat = seconds;
    times.observe(tick);
  }
  tick.interaction = {};
  times.observe(tick);
  return times;
}

// Mean 2.5, squares of differences 0.25 + 2.25 + 4 over n - 1 = 2.
TEST(TimeToCollisionMetrics, ReportMeanDeviationAndMinimum) {
  for (const auto& [metric, prefix] :
       {std::pair{"ttc_2d", "ttc"}, {"ttc_2d_cbv", "ttc_cbv"}, {"ttc_lon_lat", "ttc_lon_lat"}}) {
    test::MetricUnderTest times = shownTimes(metric);
    const std::string name = prefix;
    EXPECT_DOUBLE_EQ(*times.at(name + "_mean_s").value, 2.5) << metric;
    EXPECT_DOUBLE_EQ(*times.at(name + "_std_s").value, std::sqrt(3.25)) << metric;
    EXPECT_DOUBLE_EQ(*times.at(name + "_min_s").value, 1.0) << metric;
    EXPECT_DOUBLE_EQ(*times.at(name + "_defined_percent").value, 75.0) << metric;
  }
}

TEST(EgoCollisionsMetric, CountsContactsAndThoseThatAreTheEgosFault) {
  test::MetricUnderTest collisions("ego_collisions");
  const traffic::TrafficSnapshot snapshot = test::snapshot(1, {test::ego(0, 0, 5)});
  MetricTick tick{snapshot, nullptr, snapshot.ego()};
  tick.contacts = {{"a", {}, ""}, {"b", {}, ""}, {"c", {}, ""}, {"", {"d"}, ""}};
  EgoContact fault;
  fault.ego_at_fault = true;
  tick.ego_contacts = {fault, {}, fault};
  collisions.observe(tick);
  EXPECT_EQ(*collisions.at("ego_collisions").value, 3.0);
  EXPECT_EQ(*collisions.at("ego_contacts_at_fault").value, 2.0);
}

}  // namespace
}  // namespace cdiff::metrics
