// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>

#include "e2e_cdiff/core/exceptions.h"
#include "planners/course.h"
#include "planners/plant/plant_tokens.h"

namespace cdiff::planners {
namespace {

using testing::Points;
using testing::straight;
using testing::vehicleAt;

/// A road of 200 m along x, and the driven vehicle at its beginning.
class PlantTokens : public ::testing::Test {
 protected:
  PlantInput inputOf(const traffic::TrafficSnapshot& snapshot, double arc_length = 0.0) const {
    return plantInput(architecture_, snapshot, snapshot.vehicles.front(), route_, arc_length);
  }
  static traffic::TrafficSnapshot snapshotOf(std::vector<traffic::Vehicle> vehicles) {
    traffic::TrafficSnapshot snapshot;
    snapshot.vehicles = std::move(vehicles);
    return snapshot;
  }

  map::RoadNetwork network_ = testing::makeNetwork({{"road", straight(0.0, 0.0, 200.0, 0.0)}});
  map::Route route_ = testing::routeAlong(network_, {"road"});
  PlantArchitecture architecture_;
};

// The driven vehicle heads along +y at (10, 20), the other along -x at (8, 30): 10 m ahead, 2 m to
// the left, turned by +90 degrees. 5 m/s of 20, 1.8 m and 4.5 m of 10 m.
TEST_F(PlantTokens, AttributesAreThoseOfTheBoxInTheVehiclesFrame) {
  const traffic::Vehicle own = vehicleAt("ego", 10.0, 20.0, 0.5 * core::kPi, 3.0);
  const traffic::Vehicle other = vehicleAt("a", 8.0, 30.0, core::kPi, 5.0);
  const PlantToken token = plantToken(own.state.pose(), other.state, other.dimensions);
  const double expected[] = {10.0 / 50.0, 2.0 / 50.0, 0.5, 5.0 / 20.0, 0.18, 0.45};
  for (std::size_t i = 0; i < token.size(); ++i) EXPECT_NEAR(token[i], expected[i], 1e-6) << i;
}

// 50.1 m is too far, 3 m higher is another level; a and b are as far away as each other.
TEST_F(PlantTokens, NearVehiclesOnTheLevelNearestFirstThenById) {
  traffic::Vehicle above = vehicleAt("above", 5.0, 0.0, 0.0, 5.0);
  above.state.elevation = 3.0;
  const auto snapshot =
      snapshotOf({vehicleAt("ego", 0.0, 0.0, 0.0, 5.0), vehicleAt("far", 50.1, 0.0, 0.0, 5.0),
                  above, vehicleAt("c", 49.9, 0.0, 0.0, 5.0), vehicleAt("b", 0.0, 20.0, 0.0, 5.0),
                  vehicleAt("a", 20.0, 0.0, 0.0, 5.0)});
  EXPECT_EQ(inputOf(snapshot).ids, (std::vector<std::string>{"a", "b", "c"}));
  architecture_.vehicles = 2;
  EXPECT_EQ(inputOf(snapshot).ids, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(inputOf(snapshot).vehicles.size(), 2U);
}

// At its own place, heading ahead, with its speed of 5 of 20 m/s.
TEST_F(PlantTokens, TheDrivenVehicleIsTheFirstTokenWhereTheArchitectureSaysSo) {
  const auto snapshot =
      snapshotOf({vehicleAt("ego", 0.0, 0.0, 0.0, 5.0), vehicleAt("a", 20.0, 0.0, 0.0, 7.0)});
  EXPECT_EQ(inputOf(snapshot).ids, (std::vector<std::string>{"a"}));
  architecture_.own_vehicle = true;
  const PlantInput input = inputOf(snapshot);
  ASSERT_EQ(input.ids, (std::vector<std::string>{"ego", "a"}));
  const float expected[] = {0.0F, 0.0F, 0.0F, 0.25F};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_FLOAT_EQ(input.vehicles[0][i], expected[i]) << i;
}

TEST_F(PlantTokens, AnEmptySceneHasTheRouteAlone) {
  const PlantInput input = inputOf(snapshotOf({vehicleAt("ego", 0.0, 0.0, 0.0, 5.0)}));
  EXPECT_TRUE(input.vehicles.empty());
  EXPECT_EQ(input.route.size(), 2U);
  EXPECT_FALSE(input.red_light);
}

// 50 points of 3.5 m make one straight segment of 171.5 m, parted into 18 of 9.528 m; the first two
// count: their middles lie 4.764 m and 14.292 m ahead. The vehicle is 1.8 m wide.
TEST_F(PlantTokens, AStraightRouteIsPartedEvenlyIntoTwoTokens) {
  const auto tokens = plantRoute({{0.0, 0.0}, 0.0}, 1.8, route_, 0.0);
  ASSERT_EQ(tokens.size(), 2U);
  const double part = 171.5 / 18.0;
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(tokens[i][0], (static_cast<double>(i) + 0.5) * part / 50.0, 1e-6);
    EXPECT_NEAR(tokens[i][1], 0.0, 1e-6);
    EXPECT_NEAR(tokens[i][2], 0.0, 1e-6);
    EXPECT_EQ(tokens[i][3], static_cast<float>(i)) << "its number in place of a speed";
    EXPECT_NEAR(tokens[i][4], 0.18, 1e-6);
    EXPECT_NEAR(tokens[i][5], part / 10.0, 1e-6);
  }
}

// At 192 m there are points at 192, 195.5, 199 and the end, 200: one segment of 8 m. At the end
// there is none; the target point stays at the end.
TEST_F(PlantTokens, ARouteShorterThanTheHorizonHasWhatIsLeft) {
  const auto tokens = plantRoute({{192.0, 0.0}, 0.0}, 1.8, route_, 192.0);
  ASSERT_EQ(tokens.size(), 1U);
  EXPECT_NEAR(tokens[0][0], 4.0 / 50.0, 1e-6);
  EXPECT_NEAR(tokens[0][5], 0.8, 1e-6);
  EXPECT_TRUE(plantRoute({{200.0, 0.0}, 0.0}, 1.8, route_, 200.0).empty());
  EXPECT_TRUE(plantRoute({{203.0, 0.0}, 0.0}, 1.8, route_, 203.0).empty());
  EXPECT_NEAR(plantTargetPoint(route_, 192.0).x(), 200.0, 1e-9);
  EXPECT_NEAR(plantTargetPoint(route_, 203.0).x(), 200.0, 1e-9);
}

// Right angle after 14 m: points 0, 3.5, 7, 10.5, 14 | 3.5 m up ...; segments of 14 m and of the
// rest. The first is parted into two of 7 m, so the second has no token.
TEST_F(PlantTokens, ALongSegmentLeavesNoRoomForTheNext) {
  const map::RoadNetwork network = testing::makeNetwork(
      {{"bend", Points{{0.0, 0.0, 0.0}, {14.0, 0.0, 0.0}, {14.0, 100.0, 0.0}}}});
  const auto tokens =
      plantRoute({{0.0, 0.0}, 0.0}, 1.8, testing::routeAlong(network, {"bend"}), 0.0);
  ASSERT_EQ(tokens.size(), 2U);
  EXPECT_NEAR(tokens[0][0], 3.5 / 50.0, 1e-6);
  EXPECT_NEAR(tokens[1][0], 10.5 / 50.0, 1e-6);
  EXPECT_NEAR(tokens[1][2], 0.0, 1e-6);
}

// From 7 m on, the first segment is the 7 m to the corner, the second goes up: half a turn / 2.
TEST_F(PlantTokens, BehindAShortSegmentComesTheNext) {
  const map::RoadNetwork network = testing::makeNetwork(
      {{"bend", Points{{0.0, 0.0, 0.0}, {14.0, 0.0, 0.0}, {14.0, 100.0, 0.0}}}});
  const auto tokens =
      plantRoute({{7.0, 0.0}, 0.0}, 1.8, testing::routeAlong(network, {"bend"}), 7.0);
  ASSERT_EQ(tokens.size(), 2U);
  EXPECT_NEAR(tokens[0][5], 0.7, 1e-6);
  EXPECT_NEAR(tokens[1][0], 7.0 / 50.0, 1e-6);
  EXPECT_NEAR(tokens[1][2], 0.5, 1e-6);
}

// The vehicle stands 31 m beside the route: its segments begin too far away.
TEST_F(PlantTokens, SegmentsThatBeginFarAwayDoNotCount) {
  EXPECT_EQ(plantRoute({{0.0, 29.0}, 0.0}, 1.8, route_, 0.0).size(), 2U);
  EXPECT_TRUE(plantRoute({{0.0, 31.0}, 0.0}, 1.8, route_, 0.0).empty());
}

// Nodes at 50, 100, 150 and 200 m: from 40 m on the first that is more than 7.5 m ahead is 50 m,
// from 43 m on it is 100 m.
TEST_F(PlantTokens, TheTargetPointIsTheNextNodeThatIsNotTooNear) {
  EXPECT_NEAR(plantTargetPoint(route_, 40.0).x(), 50.0, 1e-9);
  EXPECT_NEAR(plantTargetPoint(route_, 43.0).x(), 100.0, 1e-9);
}

// A junction from 30 m to 40 m.
TEST_F(PlantTokens, TheTargetPointIsWhereAJunctionBeginsOrEnds) {
  const map::RoadNetwork network =
      testing::makeNetwork({{"in", straight(0.0, 0.0, 30.0, 0.0)},
                            {":j", straight(30.0, 0.0, 40.0, 0.0), 13.89, true},
                            {"out", straight(40.0, 0.0, 140.0, 0.0)}});
  const map::Route route = testing::routeAlong(network, {"in", ":j", "out"});
  ASSERT_EQ(route.junctionStretches().size(), 1U);
  EXPECT_NEAR(plantTargetPoint(route, 0.0).x(), route.junctionStretches()[0].first, 1e-9);
  EXPECT_NEAR(plantTargetPoint(route, 25.0).x(), route.junctionStretches()[0].second, 1e-9);
}

// The stop line lies at 100 m; a light counts from 30 m before it on.
TEST_F(PlantTokens, ARedLightAheadCountsWithinItsDistance) {
  const map::RoadNetwork network = testing::makeNetwork(
      {{"in", straight(0.0, 0.0, 100.0, 0.0)}, {"out", straight(100.0, 0.0, 200.0, 0.0)}},
      {{"in", "out", "light"}});
  const map::Route route = testing::routeAlong(network, {"in", "out"});
  const auto red = [&](const char* state, double x) {
    auto snapshot = snapshotOf({vehicleAt("ego", x, 0.0, 0.0, 5.0)});
    snapshot.signals = {{"light", state}};
    return plantInput(architecture_, snapshot, snapshot.vehicles.front(), route, x).red_light;
  };
  EXPECT_FALSE(red("r", 69.0));
  EXPECT_TRUE(red("r", 71.0));
  EXPECT_TRUE(red("y", 71.0));
  EXPECT_FALSE(red("G", 71.0));
  EXPECT_FALSE(red("r", 101.0)) << "behind the line";
}

TEST_F(PlantTokens, SizesThatDoNotFitAreNamed) {
  architecture_.heads = 3;
  try {
    architecture_.validate();
    FAIL() << "accepted";
  } catch (const core::InputError& error) {
    EXPECT_STREQ(error.what(), "width is 256; a multiple of 16 x heads was expected");
  }
}

}  // namespace
}  // namespace cdiff::planners
