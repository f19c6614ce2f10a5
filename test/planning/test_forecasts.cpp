// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "planners/course.h"
#include "planners/pdm_lite/forecasts.h"
#include "planners/pdm_lite/lateral_controller.h"
#include "planners/pdm_lite/longitudinal_controller.h"
#include "planning/route_follower.h"
#include "planning/surrounding_vehicles.h"

namespace cdiff::planning {
namespace {

using planners::testing::leftBend;
using planners::testing::makeNetwork;
using planners::testing::routeAlong;
using planners::testing::straight;
using planners::testing::vehicleAt;

// The route crosses its own beginning at (5, 0), 115 m along: 40 m east, 20 m north, 35 m west and
// 20 m south. A vehicle that starts there, nearer to the later pass, is at its beginning.
TEST(RouteFollower, StartsAtTheBeginningOfARouteThatComesBack) {
  const auto network =
      makeNetwork({{"loop", {{0, 0, 0}, {40, 0, 0}, {40, 20, 0}, {5, 20, 0}, {5, -20, 0}}}});
  const map::Route route = routeAlong(network, {"loop"});
  RouteFollower follower;
  follower.update(route, {5.0, 0.2});
  EXPECT_NEAR(follower.arcLength(), 5.0, 1e-9);
  RouteFollower later;
  later.update(route, {40.0, 12.0});  // farther than 3 m from the first 20 m
  EXPECT_NEAR(later.arcLength(), 52.0, 1e-9);
}

// 100 decisions without a CBV, at which no planner of CBVs is called.
TEST(EgoFollower, FindsAnEgoThatWasNotLookedAtForAWhile) {
  const auto network = makeNetwork({{"road", straight(0.0, 0.0, 400.0, 0.0)}});
  const map::Route route = routeAlong(network, {"road"});
  EgoFollower follower;
  traffic::TrafficSnapshot snapshot;
  for (const std::uint64_t tick : {0U, 2U, 202U}) {
    snapshot.tick = tick;
    const double x = 12.0 * 0.05 * static_cast<double>(tick);
    snapshot.vehicles = {vehicleAt("ego", x, 0.0, 0.0, 12.0)};
    snapshot.vehicles[0].role = traffic::VehicleRole::kEgo;
    follower.update(route, snapshot, 0.05);
    EXPECT_NEAR(follower.arcLength(), x, 1e-9);
  }
}

TEST(MotionForecast, HoldsTheActionOfADrivenVehicle) {
  const auto network = makeNetwork({{"road", straight(0.0, 0.0, 100.0, 0.0)}});
  traffic::Vehicle vehicle = vehicleAt("a", 0.0, 0.0, 0.0, 8.0);
  vehicle.applied_action = traffic::ControlAction{0.0, 0.0, 1.0};
  const auto states = forecastMotion(vehicle, network, {}, 20);
  ASSERT_EQ(states.size(), 20u);
  // 8 m/s - 4.952399 m/s^2 t: 3.0476 m/s after 1 s, standing from 1.6154 s on.
  EXPECT_NEAR(states[9].speed, 8.0 - 4.952399, 1e-9);
  // Euler with 0.05 s: x(1 s) = 8 - 4.952399 x 0.05^2 x (0 + 1 + ... + 19) = 8 - 4.952399 x 0.475.
  EXPECT_NEAR(states[9].position.x(), 8.0 - 4.952399 * 0.475, 1e-9);
  EXPECT_EQ(states[19].speed, 0.0);
  vehicle.applied_action = traffic::ControlAction{1.0, 0.0, 0.0};
  EXPECT_NEAR(forecastMotion(vehicle, network, {}, 20)[19].speed, 8.0 + 2.0 * 0.5633837, 1e-9);
}

TEST(MotionForecast, HeldSteerTurnsOnACircle) {
  const auto network = makeNetwork({{"road", straight(0.0, 0.0, 100.0, 0.0)}});
  traffic::Vehicle vehicle = vehicleAt("a", 0.0, 0.0, 0.0, 5.0);
  vehicle.applied_action = traffic::ControlAction{0.0, 0.3, 0.0};
  // slip = atan(1.4178275 / 1.327058485 tan(0.110545)) = 0.118032; yaw rate = 5 / 1.4178275
  // sin(slip) = 0.41527 rad/s.
  EXPECT_NEAR(forecastMotion(vehicle, network, {}, 10)[9].heading, 0.41527, 1e-4);
}

TEST(MotionForecast, FollowsTheLaneOfACarOfSumo) {
  // Straight 20 m, then a quarter circle of 12 m: the car starts 5 m before the bend, 0.5 m left of
  // the centerline.
  const auto network = makeNetwork({{"bend", leftBend(20.0, 12.0, 50.0)}});
  traffic::Vehicle vehicle = vehicleAt("a", 15.0, 0.5, 0.0, 8.0);
  vehicle.lane_id = "bend_0";
  const auto states = forecastMotion(vehicle, network, {}, 20);
  const geometry::Polyline& line = network.lane(0).centerline;
  for (const auto& state : states) {
    EXPECT_NEAR(line.project(state.position).lateral_offset, 0.5, 0.03);
  }
  // 16 m further along chords of a 12 m circle.
  EXPECT_NEAR(line.project(states[19].position).arc_length, 31.0, 0.1);
  EXPECT_EQ(states[19].speed, 8.0);
}

TEST(MotionForecast, GoesOnIntoTheNextLaneAndLimitsTheSpeed) {
  const auto network = makeNetwork(
      {{"first", straight(0.0, 0.0, 10.0, 0.0), 9.0}, {"second", leftBend(0.0, 12.0, 30.0), 9.0}},
      {{"first", "second", ""}});
  traffic::Vehicle vehicle = vehicleAt("a", 8.0, 0.0, 0.0, 8.0);
  vehicle.lane_id = "first_0";
  vehicle.acceleration = 2.0;
  const auto states = forecastMotion(vehicle, network, {}, 20);
  EXPECT_EQ(states[19].speed, 9.0);
  // The second lane starts at its own origin; the car has left the x axis there.
  EXPECT_GT(states[19].position.y(), 3.0);
}

TEST(MotionForecast, WithoutALaneHoldsYawRateAndAcceleration) {
  const auto network = makeNetwork({{"road", straight(0.0, 0.0, 100.0, 0.0)}});
  traffic::Vehicle vehicle = vehicleAt("a", 0.0, 30.0, 0.0, 4.0);
  vehicle.yaw_rate = 0.5;
  vehicle.acceleration = -1.0;
  const auto states = forecastMotion(vehicle, network, {}, 20);
  EXPECT_NEAR(states[9].heading, 0.5, 1e-9);
  EXPECT_NEAR(states[9].speed, 3.0, 1e-9);
}

TEST(MotionForecast, AStandingVehicleStays) {
  const auto network = makeNetwork({{"road", straight(0.0, 0.0, 100.0, 0.0)}});
  traffic::Vehicle vehicle = vehicleAt("a", 20.0, 0.3, 0.2, 0.0);
  vehicle.lane_id = "road_0";
  vehicle.yaw_rate = 0.4;
  const auto states = forecastMotion(vehicle, network, {}, 20);
  EXPECT_EQ(states[19].position, vehicle.state.position);
  EXPECT_EQ(states[19].heading, 0.2);
}

TEST(EgoForecast, AcceleratesTowardTheTargetAndLeavesTheDriverAlone) {
  const auto network = makeNetwork({{"road", straight(0.0, 0.0, 100.0, 0.0)}});
  const map::Route route = routeAlong(network, {"road"});
  planners::DriverState driver{RouteFollower(),
                               planners::LateralController(planners::PdmLiteOptions())};
  const traffic::Vehicle ego = vehicleAt("ego", 5.0, 0.0, 0.0, 0.0);
  driver.follower.update(route, ego.state.position);
  const auto rollout =
      planners::forecastEgo(ego.state, route, driver, 8.0, dynamics::BicycleModel(), {20, 1});
  ASSERT_EQ(rollout.size(), 20u);
  EXPECT_EQ(rollout.front().action.throttle, 1.0);
  // Full throttle for 0.1 s from rest: about 7.6 m/s^2 x 0.1 s.
  EXPECT_NEAR(rollout.front().state.speed, 0.756, 0.01);
  // Full throttle up to 0.117 m/s below the target (1.7108 x 0.42 km/h + 0.28 = 1), each time 0.1 s
  // of at most 5.5 m/s^2.
  EXPECT_GT(rollout.back().state.speed, 8.0 - 0.117);
  EXPECT_LT(rollout.back().state.speed, 8.0 - 0.117 + 0.55);
  EXPECT_NEAR(rollout.back().state.position.y(), 0.0, 1e-9);
  EXPECT_EQ(driver.follower.arcLength(), 5.0);
}

// With a decision on each simulation step the controllers act twice per point of the forecast: the
// speed is that of throttles chosen every 0.05 s, and the window of the steering has two errors.
TEST(EgoForecast, DecidesAsOftenAsTheSession) {
  const auto network = makeNetwork({{"road", straight(0.0, 0.0, 100.0, 0.0)}});
  const map::Route route = routeAlong(network, {"road"});
  planners::DriverState driver{RouteFollower(),
                               planners::LateralController(planners::PdmLiteOptions())};
  const traffic::Vehicle ego = vehicleAt("ego", 5.0, 0.3, 0.0, 7.95);
  driver.follower.update(route, ego.state.position);
  const dynamics::BicycleModel model;
  const auto rollout = planners::forecastEgo(ego.state, route, driver, 8.0, model, {1, 2});
  ASSERT_EQ(rollout.size(), 1u);
  traffic::VehicleState state = ego.state;
  for (int decision = 0; decision < 2; ++decision) {
    traffic::ControlAction action;
    action.steer = planners::steerAlong(route, state, driver);
    action.throttle = planners::forecastThrottle(state.speed, 8.0);
    state = model.step(state, action, 0.05);
  }
  EXPECT_EQ(rollout[0].state.speed, state.speed);
  EXPECT_EQ(rollout[0].state.heading, state.heading);
  const auto once = planners::forecastEgo(ego.state, route, driver, 8.0, model, {1, 1});
  EXPECT_NE(once[0].state.speed, state.speed);
}

TEST(BoxForecast, GrowsAsPublished) {
  traffic::Vehicle ego = vehicleAt("ego", 0.0, 0.0, 0.0, 4.9);
  const std::vector<RolloutPoint> points(2, RolloutPoint{ego.state, {}});
  EXPECT_DOUBLE_EQ(planners::egoBoxes(ego, points)[0].length, 4.5);
  ego.state.speed = 5.0;
  EXPECT_DOUBLE_EQ(planners::egoBoxes(ego, points)[1].length, 4.5 * 1.3);
  EXPECT_DOUBLE_EQ(planners::egoBoxes(ego, points)[1].width, 1.8 * 1.2);

  std::vector<traffic::VehicleState> states(20, ego.state);
  states[5].speed = 0.9;
  const auto boxes = planners::otherBoxes(ego.dimensions, states, 20, false);
  EXPECT_DOUBLE_EQ(boxes[0].length, 4.5 * 1.2);
  EXPECT_DOUBLE_EQ(boxes[0].width, 1.8);
  EXPECT_DOUBLE_EQ(boxes[5].length, 4.5);
  // Step i = 18 of 20: 1.3 x 18 / 20 = 1.17.
  EXPECT_DOUBLE_EQ(boxes[18].width, 1.8 * 1.17);
  EXPECT_DOUBLE_EQ(boxes[19].width, 1.8 * 1.235);
}

TEST(BoxForecast, GrowsTwiceAsLongAndWithinTheShorterHorizonNearALaneChange) {
  const traffic::Vehicle other = vehicleAt("other", 0.0, 0.0, 0.0, 5.0);
  const std::vector<traffic::VehicleState> states(20, other.state);
  const auto boxes = planners::otherBoxes(other.dimensions, states, 11, true);
  ASSERT_EQ(boxes.size(), 11u);
  EXPECT_DOUBLE_EQ(boxes[0].length, 9.0);
  EXPECT_DOUBLE_EQ(boxes[8].width, 1.8);
  // Step i = 10 of 11: 1.3 x 10 / 11 = 1.1818.
  EXPECT_DOUBLE_EQ(boxes[10].width, 1.8 * 1.3 * 10.0 / 11.0);
}

TEST(BoxForecast, BoxesMeetOnlyAtTheSameStep) {
  const geometry::OrientedBox here{{0.0, 0.0}, 0.0, 4.0, 2.0};
  const geometry::OrientedBox away{{20.0, 0.0}, 0.0, 4.0, 2.0};
  EXPECT_EQ(planners::meet({here, away}, {away, here}, 2), std::nullopt);
  EXPECT_EQ(planners::meet({away, here}, {here, here}, 2), 1U);
  EXPECT_EQ(planners::meet({away, here}, {here, here}, 1), std::nullopt);
}

}  // namespace
}  // namespace cdiff::planning
