// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Scenes of one rule each: stop lines, lane changes, bicycles, cars that cut in.
#include <gtest/gtest.h>

#include <algorithm>

#include "planners/course.h"

namespace cdiff::planners {
namespace {

using testing::ClosedLoop;
using testing::kNorth;
using testing::leftBend;
using testing::makeNetwork;
using testing::Points;
using testing::routeAlong;
using testing::straight;
using testing::vehicleAt;

/// Two roads that meet at x = 80, with a light or a stop sign.
class StopLineScene : public ::testing::Test {
 protected:
  static map::RoadNetwork network(const std::string& light, const std::string& state) {
    return makeNetwork(
        {{"in", straight(0.0, 0.0, 80.0, 0.0)}, {"out", straight(80.0, 0.0, 200.0, 0.0)}},
        {{"in", "out", light, state}});
  }
  static double toLine(const ClosedLoop& loop) { return 80.0 - loop.vehicle(0).state.position.x(); }
};

TEST_F(StopLineScene, StopsSixMetersBeforeRedAndYellowAndGoesOnGreen) {
  const map::RoadNetwork lit = network("light", "o");
  const map::Route route = routeAlong(lit, {"in", "out"});
  for (const std::string letter : {"r", "y"}) {
    ClosedLoop loop(lit);
    loop.drive(vehicleAt("ego", 5.0, 0.0, 0.0, 8.0), route);
    loop.setSignal("light", letter);
    loop.run(15.0);
    // s0 = 6 m from the center to the stop line.
    EXPECT_NEAR(toLine(loop), 6.0, 1.0) << letter;
    EXPECT_LT(loop.vehicle(0).state.speed, 0.1) << letter;
    RecordProperty("stop_distance_m_" + letter, std::to_string(toLine(loop)));
    loop.setSignal("light", "G");
    loop.run(5.0);
    EXPECT_LT(toLine(loop), -10.0) << letter;
  }
}

TEST_F(StopLineScene, LightsAreIgnoredWhereTheOptionSaysSo) {
  const map::RoadNetwork lit = network("light", "o");
  const map::Route route = routeAlong(lit, {"in", "out"});
  PdmLiteOptions options;
  options.obey_lights = false;
  ClosedLoop loop(lit, options);
  loop.drive(vehicleAt("ego", 5.0, 0.0, 0.0, 8.0), route);
  loop.setSignal("light", "r");
  loop.run(15.0);
  EXPECT_LT(toLine(loop), -10.0);
}

/// Where a car stood, and how slow it got.
struct Stop {
  double before_line = -1.0;  ///< where it was slower than 0.1 m/s first [m]
  double slowest = 1e9;       ///< [m/s]
  bool passed = false;        ///< 10 m beyond the line in the end
};

class StopSignScene : public StopLineScene {
 protected:
  static Stop driveTo(const std::string& state, const PdmLiteOptions& options) {
    const map::RoadNetwork signed_road = network("", state);
    const map::Route route = routeAlong(signed_road, {"in", "out"});
    ClosedLoop loop(signed_road, options);
    loop.drive(vehicleAt("ego", 5.0, 0.0, 0.0, 8.0), route);
    Stop stop;
    loop.run(40.0, [&] {
      const double speed = loop.vehicle(0).state.speed;
      const bool on_the_way = toLine(loop) > -10.0;
      if (on_the_way) stop.slowest = std::min(stop.slowest, speed);
      if (on_the_way && speed < 0.1 && stop.before_line < 0.0) stop.before_line = toLine(loop);
    });
    stop.passed = toLine(loop) < -10.0;
    return stop;
  }
};

// IDM rests at s0 = 2 m from the line and a sign is cleared within 3 m of it.
TEST_F(StopSignScene, StopsBeforeTheLineAndGoesOn) {
  for (const std::string state : {"s", "w"}) {
    const Stop stop = driveTo(state, {});
    EXPECT_GT(stop.before_line, 1.0) << state;
    EXPECT_LT(stop.before_line, 3.0) << state;
    EXPECT_TRUE(stop.passed) << state;
    RecordProperty("stop_distance_m_" + state, std::to_string(stop.before_line));
  }
}

TEST_F(StopSignScene, OtherRightsOfWayAndTheOptionLetItPass) {
  for (const std::string state : {"M", "m", "="}) {
    const Stop stop = driveTo(state, {});
    EXPECT_GT(stop.slowest, 7.0) << state;
    EXPECT_TRUE(stop.passed) << state;
  }
  PdmLiteOptions options;
  options.obey_stop_signs = false;
  EXPECT_GT(driveTo("s", options).slowest, 7.0);
}

TEST_F(StopSignScene, AnEvenStyleStopsTooAndGoesOn) {
  DrivingStyle style;
  style.acceleration = 2.0;
  const Stop stop = driveTo("s", testing::styled(style));
  EXPECT_GT(stop.before_line, 1.0);
  EXPECT_LT(stop.before_line, 3.0);
  EXPECT_TRUE(stop.passed);
}

// Of two signs 40 m apart each is stopped at: the first is armed again on the way.
TEST_F(StopSignScene, StopsAtEachOfTwoSigns) {
  const map::RoadNetwork road = makeNetwork({{"a", straight(0.0, 0.0, 40.0, 0.0)},
                                             {"b", straight(40.0, 0.0, 80.0, 0.0)},
                                             {"c", straight(80.0, 0.0, 200.0, 0.0)}},
                                            {{"a", "b", "", "s"}, {"b", "c", "", "s"}});
  const map::Route route = routeAlong(road, {"a", "b", "c"});
  ClosedLoop loop(road);
  loop.drive(vehicleAt("ego", 5.0, 0.0, 0.0, 8.0), route);
  std::vector<double> stops;
  loop.run(40.0, [&] {
    const double x = loop.vehicle(0).state.position.x();
    const bool stands = loop.vehicle(0).state.speed < 0.1 && x < 90.0;
    if (stands && (stops.empty() || x > stops.back() + 10.0)) stops.push_back(x);
  });
  ASSERT_EQ(stops.size(), 2u);
  for (const double before : {40.0 - stops[0], 80.0 - stops[1]}) {
    EXPECT_GT(before, 1.0);
    EXPECT_LT(before, 3.0);
  }
}

/// A road with two lanes and a route that changes from the right one (y = 0) to the left one (y =
/// 3.2) at x = 100, or does not.
class LaneChangeScene : public ::testing::Test {
 protected:
  map::Route routeThatChanges(bool changes) const {
    Points points;
    std::vector<map::LaneIndex> lanes;
    for (int x = 0; x <= 300; ++x) {
      const bool left = changes && x >= 100;
      points.emplace_back(x, changes ? 1.6 + std::clamp(0.16 * (x - 100), -1.6, 1.6) : 0.0, 0.0);
      lanes.push_back(network_.findLane(left ? "road_1" : "road_0"));
    }
    return map::Route(network_, points, lanes);
  }

  /// Whether the first decision at x = 90, where the change is near, is to brake.
  bool brakes(bool changes, const traffic::Vehicle& other, double speed = 6.0) const {
    const map::Route route = routeThatChanges(changes);
    ClosedLoop loop(network_);
    loop.drive(vehicleAt("ego", 90.0, 0.0, 0.0, speed), route);
    loop.add(other);
    loop.advance();
    return loop.actions()[0].action.brake == 1.0;
  }

  map::RoadNetwork network_ = map::RoadNetwork::fromText(
      "<net><edge id=\"road\"><lane id=\"road_0\" index=\"0\" speed=\"13.89\" shape=\"0,0 "
      "300,0\"/><lane id=\"road_1\" index=\"1\" speed=\"13.89\" shape=\"0,3.2 300,3.2\"/></edge>"
      "<edge id=\"north\"><lane id=\"north_0\" index=\"0\" speed=\"13.89\" shape=\"105,-100 "
      "105,100\"/></edge></net>",
      "two lanes");
};

TEST_F(LaneChangeScene, WhoComesFromBehindCountsOnlyNearALaneChange) {
  // 7 m behind, center to center, and 8 m/s faster: it is there after 0.3 s.
  const traffic::Vehicle behind = vehicleAt("behind", 83.0, 0.0, 0.0, 14.0);
  EXPECT_FALSE(brakes(false, behind));
  EXPECT_TRUE(brakes(true, behind));
}

TEST_F(LaneChangeScene, WhoLeadsIsNoLongerFollowedButAvoidedNearALaneChange) {
  // 11.1 m ahead at 4 m/s: IDM has s* = 4 + 6 x 0.25 + 6 x 2 / (2 sqrt(24 x 8.7)) = 5.92 m, s
  // = 11.1
  // - 4.5 = 6.6 m, and 24 (1 - (6 / 8)^4 - (5.92 / 6.6)^2) x 0.05 = -0.15 m/s, too little to brake
  // for. The boxes, the other's twice as long, are 11.1 - 4.5 - 1.3 x 2.25 = 3.7 m apart; the
  // forecast ego speeds up to 8 m/s within 0.3 s and gains 4.1 m in 1.1 s.
  const traffic::Vehicle ahead = vehicleAt("ahead", 101.1, 0.0, 0.0, 4.0);
  EXPECT_FALSE(brakes(false, ahead));
  EXPECT_TRUE(brakes(true, ahead));
}

TEST_F(LaneChangeScene, CrossingTrafficCountsFor2SecondsOr1Point1NearALaneChange) {
  // The ego's nose (2.25 m ahead, less than 8 m/s) needs about 1.6 s to x = 105 - 0.9, when the
  // other is there.
  traffic::Vehicle crossing = vehicleAt("crossing", 105.0, -12.0, kNorth, 7.0);
  crossing.lane_id = "north_0";
  EXPECT_TRUE(brakes(false, crossing));
  EXPECT_FALSE(brakes(true, crossing));
}

// On a route without a change, a car from the next lane that comes in 12 m ahead becomes the
// leader: the ego follows it and never stands.
TEST_F(LaneChangeScene, FollowsACarThatCutsIn) {
  const map::Route route = routeThatChanges(false);
  ClosedLoop loop(network_);
  loop.drive(vehicleAt("ego", 20.0, 0.0, 0.0, 8.0), route);
  loop.add(vehicleAt("cutter", 36.0, 3.2, -0.2, 5.0));
  double nearest = 1e9;
  double slowest = 1e9;
  loop.run(20.0, [&] {
    traffic::VehicleState& cutter = loop.vehicle(1).state;
    if (cutter.position.y() <= 0.0) cutter.heading = 0.0;
    nearest = std::min(nearest, geometry::distance(loop.vehicle(0).box(), loop.vehicle(1).box()));
    slowest = std::min(slowest, loop.vehicle(0).state.speed);
  });
  EXPECT_GT(nearest, 2.5);
  EXPECT_GT(slowest, 2.0);
  EXPECT_NEAR(loop.vehicle(0).state.speed, 5.0, 0.5);
  RecordProperty("nearest_m", std::to_string(nearest));
  RecordProperty("slowest_mps", std::to_string(slowest));
}

/// A road along +x.
class OpenRoad : public ::testing::Test {
 protected:
  map::RoadNetwork network_ = makeNetwork({{"east", straight(0.0, 0.0, 300.0, 0.0)}});
  map::Route route_ = routeAlong(network_, {"east"});
};

// Of what stands across the road a car is not to be met by the forecast at all, which from rest
// reaches about 11 m in 2 s; a bicycle is followed by IDM, to 4 m + its length of 1.6 m between the
// centers.
TEST_F(OpenRoad, ABicycleInTheWayIsApproachedByIdm) {
  for (const double width : {0.65, 0.8}) {
    ClosedLoop loop(network_);
    loop.drive(vehicleAt("ego", 5.0, 0.0, 0.0, 8.0), route_);
    traffic::Vehicle across = vehicleAt("across", 60.0, 0.0, kNorth, 0.0);
    across.dimensions = {1.6, width, 1.7};
    loop.add(across);
    loop.run(12.0);
    const double distance = 60.0 - loop.vehicle(0).state.position.x();
    EXPECT_LT(loop.vehicle(0).state.speed, 0.1) << width;
    if (width < 0.75) {
      EXPECT_NEAR(distance, 5.6, 1.0);
    } else {
      EXPECT_GT(distance, 9.0);
    }
    RecordProperty("distance_m_" + std::to_string(width), std::to_string(distance));
  }
}

TEST_F(OpenRoad, FollowsABicycleAtItsSpeed) {
  ClosedLoop loop(network_);
  loop.drive(vehicleAt("ego", 5.0, 0.0, 0.0, 8.0), route_);
  traffic::Vehicle bicycle = vehicleAt("bicycle", 30.0, -1.0, 0.0, 4.0);
  bicycle.dimensions = {1.6, 0.65, 1.7};
  loop.add(bicycle);
  double nearest = 1e9;
  loop.run(25.0, [&] {
    nearest = std::min(nearest, geometry::distance(loop.vehicle(0).box(), loop.vehicle(1).box()));
  });
  // 4 m + 4 m/s x 0.25 s + 1.6 m between the centers, less half of both lengths.
  EXPECT_GT(nearest, 2.0);
  EXPECT_NEAR(loop.vehicle(0).state.speed, 4.0, 0.5);
}

// IDM knows leaders along 80 m: v = 7.9 m/s, s* = 4 + 1.98 + 7.9^2 / (2 sqrt(24 x 3.72)) = 9.28 m,
// s = 74 m: 24 m/s^2 (1 - (7.9 / 8)^4 - (9.28 / 74)^2) x 0.05 s = 0.04 m/s in place of 0.1.
TEST_F(OpenRoad, LeadersCountUpTo80MetersAhead) {
  std::vector<double> throttles;
  for (const double distance : {78.5, 84.0}) {
    ClosedLoop loop(network_);
    loop.drive(vehicleAt("ego", 5.0, 0.0, 0.0, 7.9), route_);
    loop.add(vehicleAt("leader", 5.0 + distance, 0.0, 0.0, 0.0));
    loop.advance();
    throttles.push_back(loop.actions()[0].action.throttle);
  }
  EXPECT_LT(throttles[0], throttles[1] - 0.1);
}

// The original gains belong to twenty decisions a second; with them the lane is kept, too.
TEST(OriginalConfiguration, KeepsItsLaneInATwelveMetreBend) {
  const auto network = makeNetwork({{"bend", leftBend(60.0, 12.0, 60.0)}});
  const map::Route route = routeAlong(network, {"bend"});
  PdmLiteOptions options;
  options.configuration = "original";
  ClosedLoop loop(network, options, 0.05);
  loop.drive(vehicleAt("ego", 5.0, 0.0, 0.0, 0.0), route);
  double worst = 0.0;
  loop.run(16.0, [&] {
    worst = std::max(worst, route.path().project(loop.vehicle(0).state.position).distance);
  });
  EXPECT_GT(loop.vehicle(0).state.position.y(), 40.0);
  EXPECT_LT(worst, 0.6);
  RecordProperty("worst_offset_m", std::to_string(worst));
}

TEST_F(OpenRoad, ForecastsADecisionOnEachSimulationStepWhereThereIsOne) {
  PdmLiteOptions options;
  options.configuration = "original";
  ClosedLoop loop(network_, options, 0.05);
  loop.drive(vehicleAt("ego", 5.0, 0.3, 0.0, 7.95), route_);
  loop.advance();
  const planning::RolloutPoint forecast = loop.actions().front().rollout.front();
  loop.advance();
  EXPECT_NEAR(forecast.state.speed, loop.vehicle(0).state.speed, 1e-9);
  EXPECT_NEAR(forecast.state.heading, loop.vehicle(0).state.heading, 1e-9);
}

}  // namespace
}  // namespace cdiff::planners
