// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "metrics/formulas/free_road.h"
#include "metrics/straight_road.h"
#include "support/network_text.h"

namespace cdiff::metrics {
namespace {

using test::background;
using test::cbv;

/// A CBV of 4.8 m x 1.8 m stands at x = 50, its front at 52.4: free up to 62.4.
class FreeRoadTest : public ::testing::Test {
 protected:
  bool isFree(std::vector<traffic::Vehicle> others) const {
    others.insert(others.begin(), cbv("a", 50, 0, 0));
    return isRoadFree(others.front(), road_.route, test::snapshot(0, others));
  }
  test::StraightRoad road_;
};

TEST_F(FreeRoadTest, IsFreeAlone) { EXPECT_TRUE(isFree({})); }

TEST_F(FreeRoadTest, EndsAtAVehicleWithinTenMeters) {
  // Rear = center - 2.4.
  EXPECT_FALSE(isFree({background("v", 64.7, 0, 0)}));
  EXPECT_TRUE(isFree({background("v", 64.9, 0, 0)}));
  EXPECT_TRUE(isFree({background("v", 45.0, 0, 0)}));
}

TEST_F(FreeRoadTest, LeavesAQuarterOfAMeterToEachSide) {
  // Half of 1.8 + 0.5 m is 1.15 m, half the other 0.9 m: they touch at 2.05 m.
  EXPECT_FALSE(isFree({background("v", 57, 2.0, 0)}));
  EXPECT_TRUE(isFree({background("v", 57, 2.1, 0)}));
}

TEST_F(FreeRoadTest, IsOnTheLevelOfTheVehicle) {
  traffic::Vehicle above = background("v", 57, 0, 0);
  above.state.elevation = 6.0;
  EXPECT_TRUE(isFree({above}));
}

TEST(StripAlong, HasBoxesOfAtMostTwoMeters) {
  const test::StraightRoad road;
  for (const double length : {1.0, 2.0, 5.0, 5.9}) {
    const auto strip = stripAlong(road.route.path(), 10.0, 10.0 + length, 1.5);
    double whole = 0.0;
    for (const geometry::OrientedBox& box : strip) {
      EXPECT_LE(box.length, 2.0 + 1e-9);
      EXPECT_EQ(box.width, 1.5);
      whole += box.length;
    }
    EXPECT_NEAR(whole, length, 1e-9);
  }
  EXPECT_TRUE(stripAlong(road.route.path(), 10.0, 10.0, 1.5).empty());
}

/// A lane east to x = 60, a junction of 10 m with a light, and a lane on; the route along all.
class FreeRoadAtALight : public ::testing::Test {
 protected:
  FreeRoadAtALight() {
    std::vector<Eigen::Vector3d> points;
    std::vector<map::LaneIndex> lanes;
    for (int x = 0; x < 130; x += 2) {
      points.emplace_back(x, 0.0, 0.0);
      lanes.push_back(network_.findLane(x < 60 ? "in_0" : x < 70 ? ":j_0_0" : "out_0"));
    }
    route_ = map::Route(network_, points, lanes);
  }
  /// With the front at this x.
  bool isFree(double front, const std::string& color,
              std::vector<traffic::Vehicle> others = {}) const {
    others.insert(others.begin(), cbv("a", front - 2.4, 0, 0));
    traffic::TrafficSnapshot snapshot = test::snapshot(0, others);
    snapshot.signals = {{"j", color}};
    return isRoadFree(snapshot.vehicles.front(), route_, snapshot);
  }

  map::RoadNetwork network_ =
      test::NetworkText()
          .edge("in", {"0,0 60,0"}, "a", "j")
          .edge("out", {"70,0 170,0"}, "j", "b")
          .edge(":j_0", {"60,0 70,0"})
          .connection("in_0", "out_0", ":j_0_0", 's', R"(tl="j" linkIndex="0" state="o")")
          .network();
  map::Route route_;
};

TEST_F(FreeRoadAtALight, EndsAtRedAndYellowUpToTenMetersAhead) {
  ASSERT_EQ(route_.signals().size(), 1U);
  for (const char* color : {"r", "u", "y", "Y"}) EXPECT_FALSE(isFree(58.0, color)) << color;
  for (const char* color : {"g", "G"}) EXPECT_TRUE(isFree(58.0, color)) << color;
  // The line is at 60: 10 m are from 50 on. One meter beyond it a vehicle still stands at it.
  EXPECT_FALSE(isFree(50.5, "r"));
  EXPECT_TRUE(isFree(49.5, "r"));
  EXPECT_FALSE(isFree(60.9, "r"));
  EXPECT_TRUE(isFree(61.1, "r"));
}

TEST_F(FreeRoadAtALight, MayHaveToYieldToWhatMovesNearTheJunction) {
  // The other is 20 m beside; moving it excuses, standing it does not, nor farther than 25 m away,
  // nor where the junction (from 60 on) is more than 10 m ahead.
  EXPECT_FALSE(isFree(58.0, "g", {background("v", 55.6, 20, 3)}));
  EXPECT_TRUE(isFree(58.0, "g", {background("v", 55.6, 20, 0.05)}));
  EXPECT_TRUE(isFree(58.0, "g", {background("v", 55.6, 25.5, 3)}));
  EXPECT_TRUE(isFree(49.0, "g", {background("v", 46.6, 20, 3)}));
  // In the junction, from 60 to 70, and behind it; the center counts, 2.4 m behind the front.
  EXPECT_FALSE(isFree(69.0, "g", {background("v", 66.6, 20, 3)}));
  EXPECT_TRUE(isFree(74.0, "g", {background("v", 71.6, 20, 3)}));
}

}  // namespace
}  // namespace cdiff::metrics
