// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "planners/constant/constant.h"
#include "planners/course.h"
#include "planners/registry.h"

namespace cdiff::planners {
namespace {

/// One vehicle driven by `constant` for some time: decisions every 0.1 s, dynamics every 0.05 s.
class Drive {
 public:
  Drive(const map::Route& route, const std::string& speed, double start_speed)
      : route_(route), vehicle_(testing::vehicleAt("a", 0.0, 0.0, 0.0, start_speed)) {
    planning::PlannerOptionsTable options = defaultOptions();
    core::overrideOption("constant.speed=" + speed, "test", options);
    planner_ = makePlanner("constant", {{network_, area_}, options, dynamics_, camera_, guidance_});
  }

  planning::PlannedAction decide(double target_speed = 8.0) {
    return planner_->plan({}, {{0, &vehicle_, &route_, target_speed}}).at(0);
  }
  /// Notes the largest distance from the route and change of speed per decision.
  void run(double seconds) {
    for (int i = 0; i < std::lround(seconds / 0.1); ++i) {
      const double before = vehicle_.state.speed;
      vehicle_.state = model_.step(vehicle_.state, decide().action, 0.1);
      largest_change_ = std::max(largest_change_, std::abs(vehicle_.state.speed - before));
      farthest_ = std::max(farthest_,
                           std::abs(route_.path().project(vehicle_.state.position).lateral_offset));
    }
  }
  traffic::Vehicle& vehicle() { return vehicle_; }
  const traffic::VehicleState& state() const { return vehicle_.state; }
  double farthest() const { return farthest_; }
  double largestChange() const { return largest_change_; }

 private:
  const map::Route& route_;
  traffic::Vehicle vehicle_;
  map::RoadNetwork network_ =
      testing::makeNetwork({{"any", testing::straight(0.0, 0.0, 10.0, 0.0)}});
  map::DrivableArea area_{network_};
  dynamics::BicycleModelOptions dynamics_;
  dynamics::BicycleModel model_;
  rendering::CameraOptions camera_;
  guidance::GuidanceOptions guidance_;
  std::unique_ptr<planning::Planner> planner_;
  double farthest_ = 0.0;
  double largest_change_ = 0.0;
};

class ConstantSpeedTest : public ::testing::Test {
 protected:
  map::RoadNetwork network_ =
      testing::makeNetwork({{"road", testing::straight(0.0, 0.0, 200.0, 0.0)},
                            {"bend", testing::leftBend(40.0, 15.0, 100.0)}});
  map::Route road_ = testing::routeAlong(network_, {"road"});
  map::Route bend_ = testing::routeAlong(network_, {"bend"});
};

// 8 m/s at 3 m/s^2 take 2.7 s; pedals come in steps of 0.02, which change the speed of a decision
// by up to 0.01 m/s too much.
TEST_F(ConstantSpeedTest, SpeedsUpToItsSpeedAndKeepsIt) {
  Drive drive(road_, "8", 0.0);
  drive.run(2.0);
  EXPECT_NEAR(drive.state().speed, 6.0, 0.1);
  drive.run(2.0);
  EXPECT_NEAR(drive.state().speed, 8.0, 0.01);
  drive.run(10.0);
  EXPECT_NEAR(drive.state().speed, 8.0, 0.01);
  EXPECT_LT(drive.largestChange(), 0.32);
}

TEST_F(ConstantSpeedTest, SlowsDownToItsSpeed) {
  Drive drive(road_, "5", 13.0);
  drive.run(2.0);
  EXPECT_NEAR(drive.state().speed, 7.0, 0.1);
  drive.run(2.0);
  EXPECT_NEAR(drive.state().speed, 5.0, 0.01);
}

TEST_F(ConstantSpeedTest, VStarBoundsItsSpeed) {
  Drive drive(road_, "8", 6.0);
  EXPECT_GT(drive.decide(8.0).action.throttle, 0.3);
  EXPECT_EQ(drive.decide(4.0).action.throttle, 0.0);
  EXPECT_GT(drive.decide(4.0).action.brake, 0.0);
  EXPECT_EQ(drive.decide(0.0).action.brake, 1.0);
}

// From 8 m/s at 8 m/s^2: 4 m, and 0.2 m for the speed that an Euler step begins with.
TEST_F(ConstantSpeedTest, WithSpeedZeroItStopsAndStandsStill) {
  Drive drive(road_, "0", 8.0);
  drive.run(1.5);
  EXPECT_EQ(drive.state().speed, 0.0);
  const Eigen::Vector2d stopped = drive.state().position;
  EXPECT_NEAR(stopped.x(), 4.2, 0.1);
  drive.run(5.0);
  EXPECT_EQ(drive.state().position, stopped);
}

// A bend of 15 m at 8 m/s; without steering the vehicle would leave the route by more than 15 m.
TEST_F(ConstantSpeedTest, FollowsItsRouteRoundABend) {
  Drive drive(bend_, "8", 8.0);
  drive.run(10.0);
  EXPECT_LT(drive.farthest(), 0.25);
  EXPECT_NEAR(drive.state().heading, testing::kNorth, 0.02);
  EXPECT_NEAR(drive.state().speed, 8.0, 0.01);
}

TEST_F(ConstantSpeedTest, StopsAtTheEndOfItsRoute) {
  Drive drive(road_, "8", 8.0);
  drive.run(24.9);  // 199 m
  EXPECT_NEAR(drive.state().speed, 8.0, 0.01);
  drive.run(2.0);
  EXPECT_EQ(drive.state().speed, 0.0);
  EXPECT_LT(drive.state().position.x(), 200.0 + 4.2 + 0.8 + 0.1);
}

TEST_F(ConstantSpeedTest, WithoutARouteOrAFiniteStateItBrakesWithAFault) {
  Drive drive(road_, "8", 8.0);
  drive.vehicle().state.position.x() = std::numeric_limits<double>::quiet_NaN();
  const planning::PlannedAction lost = drive.decide();
  EXPECT_EQ(lost.fault, "vehicle 'a': its state is not finite; full braking instead");
  EXPECT_EQ(lost.action, traffic::ControlAction::failSafe());
  const map::Route none;
  EXPECT_EQ(Drive(none, "8", 8.0).decide().fault,
            "vehicle 'a': it has no route; full braking instead");
}

TEST_F(ConstantSpeedTest, DrivesEgosAndCbvsWithoutImages) {
  const planning::PlannerDescriptor* descriptor = findPlanner("constant");
  ASSERT_NE(descriptor, nullptr);
  EXPECT_TRUE(descriptor->drives_ego);
  EXPECT_TRUE(descriptor->drives_cbv);
  EXPECT_FALSE(descriptor->sees());
}

}  // namespace
}  // namespace cdiff::planners
