// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Forecasts of vehicles along lanes and routes: where they leave them, and what they hold.
#include <gtest/gtest.h>

#include "planners/course.h"
#include "planning/surrounding_vehicles.h"
#include "support/network_text.h"

namespace cdiff::planning {
namespace {

using planners::testing::makeNetwork;
using planners::testing::routeAlong;
using planners::testing::straight;
using planners::testing::vehicleAt;
using traffic::Vehicle;
using traffic::VehicleState;

constexpr std::size_t kSecond = 10;  // steps

VehicleState after(const Vehicle& vehicle, const map::RoadNetwork& network, std::size_t steps) {
  return forecastMotion(vehicle, network, {}, steps).back();
}

Vehicle onLane(Vehicle vehicle, const std::string& lane = "road_0") {
  vehicle.lane_id = lane;
  return vehicle;
}

// Slip 0.118032 rad as in MotionForecast.HeldSteerTurnsOnACircle; the first half of the step goes
// 0.25 m in that direction, the second 0.41527 rad/s x 0.05 s = 0.020764 rad farther left: 0.25
// (cos 0.118032 + cos 0.138796), 0.25 (sin 0.118032 + sin 0.138796).
TEST(HeldAction, MovesInTheDirectionOfTheSlip) {
  const auto network = makeNetwork({{"road", straight(0.0, 0.0, 100.0, 0.0)}});
  Vehicle vehicle = vehicleAt("a", 10.0, 20.0, 0.0, 5.0);
  vehicle.applied_action = traffic::ControlAction{0.0, 0.3, 0.0};
  const VehicleState state = after(vehicle, network, 1);
  EXPECT_NEAR(state.position.x(), 10.495857, 1e-5);
  EXPECT_NEAR(state.position.y(), 20.064027, 1e-5);
  // Half braking leaves half of the throttle: 0.5 (0.5633837 - 4.952399) = -2.1945077 m/s^2.
  vehicle.applied_action = traffic::ControlAction{1.0, 0.0, 0.5};
  EXPECT_NEAR(after(vehicle, network, kSecond).speed, 5.0 - 2.1945077, 1e-6);
}

// At 4 m/s and 0.5 rad/s a step of 0.1 s goes 0.4 m in the direction at its middle, 0.025 rad.
TEST(HeldYawRate, TurnsAboutTheMiddleOfAStepAndNotInPlace) {
  const auto network = makeNetwork({{"road", straight(0.0, 0.0, 100.0, 0.0)}});
  Vehicle vehicle = vehicleAt("a", 0.0, 30.0, 0.0, 4.0);
  vehicle.yaw_rate = 0.5;
  EXPECT_NEAR(after(vehicle, network, 1).position.x(), 0.4 * std::cos(0.025), 1e-12);
  EXPECT_NEAR(after(vehicle, network, 1).position.y(), 30.0 + 0.4 * std::sin(0.025), 1e-12);
  vehicle.state.speed = 0.0;
  EXPECT_EQ(after(vehicle, network, kSecond).heading, 0.0);
}

TEST(HeldAcceleration, StaysWithinWhatCarsDo) {
  const auto network = makeNetwork({{"road", straight(0.0, 0.0, 100.0, 0.0), 30.0}});
  for (const std::string lane : {"", "road_0"}) {
    Vehicle vehicle = onLane(vehicleAt("a", 10.0, 0.0, 0.0, 8.0), lane);
    vehicle.acceleration = 9.0;
    EXPECT_NEAR(after(vehicle, network, kSecond).speed, 8.0 + 3.0, 1e-9) << lane;
    vehicle.acceleration = -9.0;
    EXPECT_NEAR(after(vehicle, network, kSecond).speed, 8.0 - 4.952399, 1e-9) << lane;
    EXPECT_EQ(after(vehicle, network, 2 * kSecond).speed, 0.0) << lane;
  }
}

TEST(LaneForecast, HoldsASpeedAboveTheLimit) {
  const auto network = makeNetwork({{"road", straight(0.0, 0.0, 100.0, 0.0), 9.0}});
  Vehicle vehicle = onLane(vehicleAt("a", 10.0, 0.0, 0.0, 15.0));
  vehicle.acceleration = 1.0;
  EXPECT_EQ(after(vehicle, network, kSecond).speed, 15.0);
}

// The lane leads up by 0.1 m a meter. Who follows it takes its heading, the others keep theirs.
TEST(LaneForecast, IsForThoseAtMost2_5MetersAsideAnd60DegreesTurned) {
  const auto network = makeNetwork({{"road", {{0.0, 0.0, 0.0}, {100.0, 0.0, 10.0}}}});
  const auto follows = [&](double y, double degrees) {
    const double heading = core::degreesToRadians(degrees);
    const Vehicle vehicle = onLane(vehicleAt("a", 50.0, y, heading, 8.0));
    const VehicleState state = after(vehicle, network, 1);
    const bool on_lane = state.heading == 0.0;
    EXPECT_NEAR(state.heading, on_lane ? 0.0 : heading, 1e-12);
    EXPECT_NEAR(state.elevation, on_lane ? 5.08 : 0.0, 1e-9);
    if (on_lane) {
      EXPECT_NEAR(state.position.y(), y, 1e-9);
    }
    return on_lane;
  };
  EXPECT_TRUE(follows(2.49, 10.0));
  EXPECT_FALSE(follows(2.51, 10.0));
  EXPECT_TRUE(follows(-2.49, 10.0));
  EXPECT_FALSE(follows(-2.51, 10.0));
  EXPECT_TRUE(follows(0.0, 59.0));
  EXPECT_FALSE(follows(0.0, 61.0));
  EXPECT_FALSE(follows(0.0, -61.0));
}

// SUMO names the lane of the front bumper, so a center may lie before the lane: 2 m before it, 0.8
// m are driven in a step. Without a next lane it goes straight on beyond the end.
TEST(LaneForecast, GoesStraightOnBeforeAndBehindTheLane) {
  const auto network = makeNetwork({{"road", straight(10.0, 0.0, 50.0, 0.0)}});
  EXPECT_NEAR(after(onLane(vehicleAt("a", 8.0, 0.3, 0.0, 8.0)), network, 1).position.x(), 8.8,
              1e-9);
  const VehicleState beyond = after(onLane(vehicleAt("a", 49.0, 0.3, 0.0, 8.0)), network, kSecond);
  EXPECT_NEAR(beyond.position.x(), 57.0, 1e-9);
  EXPECT_NEAR(beyond.position.y(), 0.3, 1e-9);
}

// From x = 20 one lane turns left, the other goes straight on and then right; 8 m are driven.
TEST(LaneForecast, TakesTheStraightLaneOfAForkAndNoneOfTwoTurns) {
  const auto ending = [](char second) {
    const map::RoadNetwork network = test::NetworkText()
                                         .edge("road", {"0,0 20,0"}, "a", "b")
                                         .edge("left", {"20,0 20,50"}, "b", "c")
                                         .edge("right", {"20,0 24,0 24,-50"}, "b", "d")
                                         .connection("road_0", "left_0", "", 'l')
                                         .connection("road_0", "right_0", "", second)
                                         .network();
    return after(onLane(vehicleAt("a", 18.0, 0.0, 0.0, 8.0)), network, kSecond).position;
  };
  EXPECT_LT((ending('s') - Eigen::Vector2d(24.0, -2.0)).norm(), 1e-9);
  EXPECT_LT((ending('r') - Eigen::Vector2d(26.0, 0.0)).norm(), 1e-9);
}

// Route west from x = 100 to 0, the vehicle 0.5 m left of it, which is south.
class RouteForecast : public ::testing::Test {
 protected:
  std::vector<VehicleState> states(double x, double speed, double acceleration) const {
    Vehicle vehicle = vehicleAt("a", x, -0.5, core::kPi, speed);
    vehicle.acceleration = acceleration;
    return forecastAlongRoute(vehicle, route_, 100.0 - x, 2 * kSecond);
  }
  map::RoadNetwork network_ = makeNetwork({{"road", straight(100.0, 0.0, 0.0, 0.0)}});
  map::Route route_ = routeAlong(network_, {"road"});
};

// 4 m/s and 2 m/s^2: 4.2, 4.4, ... 6 m/s in the first second, 0.1 (40 + 0.2 x 55) = 5.1 m; then 6
// m/s.
TEST_F(RouteForecast, HoldsTheAccelerationForASecondAndTheOffset) {
  const auto all = states(95.0, 4.0, 2.0);
  ASSERT_EQ(all.size(), 2 * kSecond);
  EXPECT_NEAR(all[0].speed, 4.2, 1e-12);
  EXPECT_NEAR(all[0].position.x(), 95.0 - 0.42, 1e-9);
  EXPECT_NEAR(all[9].position.x(), 95.0 - 5.1, 1e-9);
  EXPECT_NEAR(all[19].position.x(), 95.0 - 5.1 - 6.0, 1e-9);
  EXPECT_NEAR(all[19].speed, 6.0, 1e-12);
  for (const VehicleState& state : all) {
    EXPECT_NEAR(state.position.y(), -0.5, 1e-9);
    EXPECT_NEAR(std::abs(state.heading), core::kPi, 1e-9);
  }
}

TEST_F(RouteForecast, StopsAndDoesNotReverse) {
  const auto all = states(95.0, 0.4, -1.0);
  EXPECT_EQ(all[3].speed, 0.0);
  EXPECT_EQ(all[19].speed, 0.0);
  EXPECT_EQ(all[19].position, all[3].position);
}

TEST_F(RouteForecast, GoesStraightOnBeyondTheEnd) {
  const VehicleState last = states(1.0, 8.0, 0.0).back();
  EXPECT_NEAR(last.position.x(), 1.0 - 16.0, 1e-9);
  EXPECT_NEAR(last.position.y(), -0.5, 1e-9);
  EXPECT_NEAR(std::abs(last.heading), core::kPi, 1e-9);
}

}  // namespace
}  // namespace cdiff::planning
