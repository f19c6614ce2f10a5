// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "metrics/session_metrics.h"
#include "metrics/straight_road.h"

namespace cdiff::metrics {
namespace {

using test::background;
using test::cbv;

/// Decisions 0.1 s apart of a CBV whose route is that of the straight road.
class CbvStandingMetric : public ::testing::Test {
 protected:
  CbvStandingMetric() {
    selection_.assignments.resize(1);
    selection_.assignments[0].vehicle_id = "a";
    selection_.assignments[0].conflict_aware_route = road_.route;
  }
  /// At the even ticks from `begin` up to `end`, at x and with this speed, with others beside.
  void drive(std::uint64_t begin, std::uint64_t end, double x, double speed,
             const std::vector<traffic::Vehicle>& others = {}) {
    for (std::uint64_t tick = begin; tick < end; tick += 2) {
      std::vector<traffic::Vehicle> vehicles = {cbv("a", x, 0, speed)};
      vehicles.insert(vehicles.end(), others.begin(), others.end());
      metrics_.observe(test::snapshot(tick, vehicles), &selection_);
    }
  }
  double value(const std::string& name) const {
    return metrics_.measures().at(name).value.value_or(-1.0);
  }

  test::StraightRoad road_;
  cbv::CbvSelection selection_;
  SessionMetrics metrics_{{}, road_.drivable_area, road_.route};
};

TEST_F(CbvStandingMetric, CountsAStandOfMoreThanThreeSeconds) {
  drive(0, 2, 10, 5);
  drive(2, 64, 20, 0);  // 31 decisions: 3.0 s from the first to the last
  EXPECT_EQ(value("cbv_standing_free"), 0.0);
  EXPECT_EQ(value("cbv_standing_free_percent"), 0.0);
  drive(64, 66, 20, 0);  // 3.1 s
  EXPECT_EQ(value("cbv_standing_free"), 1.0);
  EXPECT_EQ(metrics_.measures().at("cbv_standing_free").n, 1U);
  // 32 of 33 decisions; one CBV in 10 m.
  EXPECT_NEAR(value("cbv_standing_free_percent"), 100.0 * 32.0 / 33.0, 1e-9);
  EXPECT_NEAR(value("cbv_standing_free_per_km"), 100.0, 1e-9);
  drive(66, 68, 20, 0);
  EXPECT_NEAR(value("cbv_standing_free_percent"), 100.0 * 33.0 / 34.0, 1e-9);
}

TEST_F(CbvStandingMetric, StartsAnewAfterAMoveAndWhereTheRoadWasNotFree) {
  drive(0, 60, 20, 0);
  drive(60, 62, 20, 0.1);  // 0.1 m/s is driving
  drive(62, 122, 20, 0);
  drive(122, 124, 20, 0, {background("v", 30, 0, 0)});
  drive(124, 184, 20, 0);
  EXPECT_EQ(value("cbv_standing_free"), 0.0);
}

TEST_F(CbvStandingMetric, StartsAnewWhereTheVehicleWasNoCbvMeanwhile) {
  drive(0, 20, 20, 0);
  metrics_.observe(test::snapshot(20, {background("a", 20, 0, 0)}), nullptr);
  drive(200, 240, 20, 0);
  EXPECT_EQ(value("cbv_standing_free"), 0.0);
}

TEST_F(CbvStandingMetric, CountsACbvOnce) {
  drive(0, 80, 20, 0);
  drive(80, 82, 20, 3);
  drive(82, 162, 20, 0);
  EXPECT_EQ(value("cbv_standing_free"), 1.0);
  EXPECT_NEAR(value("cbv_standing_free_percent"), 100.0 * 80.0 / 81.0, 1e-9);
}

TEST_F(CbvStandingMetric, IsAbsentWithoutARoute) {
  metrics_.observe(test::snapshot(0, {cbv("a", 10, 0, 0)}), nullptr);
  EXPECT_EQ(metrics_.measures().at("cbv_standing_free").reason, "no CBV had a route at a decision");
  EXPECT_FALSE(metrics_.measures().at("cbv_standing_free_percent").value.has_value());
}

}  // namespace
}  // namespace cdiff::metrics
