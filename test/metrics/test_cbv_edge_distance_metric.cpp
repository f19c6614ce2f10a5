// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/core/angle.h"
#include "metrics/session_metrics.h"
#include "metrics/straight_road.h"

namespace cdiff::metrics {
namespace {

class CbvEdgeDistanceMetric : public ::testing::Test {
 protected:
  void observe(std::uint64_t tick, double y, double degrees = 0.0) {
    traffic::Vehicle vehicle = test::cbv("a", 50, y, 5);
    vehicle.state.heading = core::degreesToRadians(degrees);
    metrics_.observe(test::snapshot(tick, {vehicle}), nullptr);
  }
  Measure at(const char* name) const { return metrics_.measures().at(name); }

  test::StraightRoad road_;
  SessionMetrics metrics_{{}, road_.drivable_area, road_.route};
};

TEST_F(CbvEdgeDistanceMetric, IsThatOfTheCornerFarthestOut) {
  // The road ends at y = +-1.6 and half a width is 0.9: 0.7 m in the middle, 0.2 m at y = -0.5.
  observe(0, 0.0);
  EXPECT_NEAR(*at("cbv_edge_distance_mean_m").value, 0.7, 1e-6);
  observe(1, 1.5);  // no decision
  EXPECT_EQ(at("cbv_edge_distance_mean_m").n, 1U);
  observe(2, -0.5);
  EXPECT_NEAR(*at("cbv_edge_distance_mean_m").value, 0.45, 1e-6);
  // Across the road the corners are at y = +-2.4: 0.8 m off it. Mean (0.7 + 0.2 - 0.8) / 3; 5 % of
  // the two steps between -0.8, 0.2 and 0.7 lie a tenth of a step above the least.
  observe(4, 0.0, 90.0);
  EXPECT_NEAR(*at("cbv_edge_distance_mean_m").value, 0.1 / 3.0, 1e-6);
  EXPECT_NEAR(*at("cbv_edge_distance_p5_m").value, -0.7, 1e-6);
  EXPECT_EQ(at("cbv_edge_distance_p5_m").n, 3U);
}

TEST_F(CbvEdgeDistanceMetric, IsAbsentWithoutCbv) {
  EXPECT_EQ(at("cbv_edge_distance_mean_m").reason, "no CBV was driven");
  EXPECT_EQ(at("cbv_edge_distance_p5_m").reason, "no CBV was driven");
}

}  // namespace
}  // namespace cdiff::metrics
