// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/core/angle.h"
#include "metrics/session_metrics.h"
#include "metrics/straight_road.h"
#include "support/network_text.h"

namespace cdiff::metrics {
namespace {

/// A lane east along y = 0 and a lane west along y = 4, both 4 m broad and from x = 0 to 100, then
/// a junction lane east from x = 100 to 120, alone.
class CbvWrongWayMetric : public ::testing::Test {
 protected:
  CbvWrongWayMetric() {
    SessionMetricsOptions options;
    options.network = &network_;
    metrics_ = std::make_unique<SessionMetrics>(options, area_, route_);
  }
  void observe(double x, double y, double degrees, double speed) {
    traffic::Vehicle vehicle = test::cbv("a", x, y, speed);
    vehicle.state.heading = core::degreesToRadians(degrees);
    metrics_->observe(test::snapshot(2 * decision_++, {vehicle}), nullptr);
  }
  Measure measure() const { return metrics_->measures().at("cbv_wrong_way_percent"); }

  map::RoadNetwork network_ = test::NetworkText()
                                  .edge("east", {"0,0 100,0"}, "a", "j")
                                  .edge("west", {"100,4 0,4"}, "j", "a")
                                  .edge(":j_0", {"100,0 120,0"})
                                  .network();
  map::DrivableArea area_{network_};
  map::Route route_;
  std::unique_ptr<SessionMetrics> metrics_;
  std::uint64_t decision_ = 0;
};

TEST_F(CbvWrongWayMetric, IsAShareOfTheDistance) {
  observe(50, 0, 0, 6);
  observe(50, 4, 180, 2);
  EXPECT_EQ(*measure().value, 0.0);
  observe(50, 4, 0, 2);  // 2 of 6 + 2 + 2
  EXPECT_NEAR(*measure().value, 20.0, 1e-9);
  EXPECT_EQ(measure().n, 3U);
  observe(50, 4, 0, 0);  // standing adds no distance
  EXPECT_NEAR(*measure().value, 20.0, 1e-9);
}

TEST_F(CbvWrongWayMetric, SetsInBeyondNinetyDegrees) {
  observe(50, 0, 89, 5);
  EXPECT_EQ(*measure().value, 0.0);
  observe(50, 0, -91, 5);
  EXPECT_NEAR(*measure().value, 50.0, 1e-9);
}

TEST_F(CbvWrongWayMetric, LeavesOutJunctionsAndWhatIsOnNoLane) {
  observe(110, 0, 180, 5);  // in the junction
  observe(50, 6.1, 0, 5);   // 0.1 m beyond the lane west
  EXPECT_EQ(measure().reason, "no CBV drove on a lane outside junctions");
  EXPECT_FALSE(measure().value.has_value());
}

TEST_F(CbvWrongWayMetric, IsRightOnTheBorderOfBothLanes) {
  observe(50, 2, 0, 5);
  observe(50, 2, 180, 5);
  EXPECT_EQ(*measure().value, 0.0);
}

TEST_F(CbvWrongWayMetric, IsAbsentWithoutCbv) { EXPECT_EQ(measure().reason, "no CBV was driven"); }

}  // namespace
}  // namespace cdiff::metrics
