// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "e2e_cdiff/core/exceptions.h"
#include "planners/careful_driver/careful_driver.h"
#include "planners/course.h"
#include "planners/registry.h"
#include "reference_driver/careful_driver.h"

namespace cdiff::planners {
namespace {

/// An ego on a straight road driven by `careful_driver`, with others that keep their velocity:
/// decisions every 0.1 s, dynamics every 0.05 s.
class Drive {
 public:
  explicit Drive(const std::vector<std::string>& assignments = {}, double start_speed = 8.0) {
    planning::PlannerOptionsTable options = defaultOptions();
    for (const std::string& assignment : assignments)
      core::overrideOption("careful_driver." + assignment, "test", options);
    options.validate();
    planner_ =
        makePlanner("careful_driver", {{network_, area_}, options, dynamics_, camera_, guidance_});
    snapshot_.vehicles.push_back(testing::vehicleAt("ego", 10.0, 0.0, 0.0, start_speed));
  }
  void add(const traffic::Vehicle& vehicle) { snapshot_.vehicles.push_back(vehicle); }

  planning::PlannedAction decide() {
    return planner_->plan(snapshot_, {{-1, &snapshot_.vehicles[0], &route_, 8.0}}).at(0);
  }
  /// Notes the strongest braking and the least distance of the boxes.
  void run(double seconds) {
    for (int i = 0; i < std::lround(seconds / 0.1); ++i) {
      const traffic::ControlAction action = decide().action;
      if (action.brake > 0.9 && brake_time_ < 0.0) brake_time_ = snapshot_.time;
      for (int tick = 0; tick < 2; ++tick) step(action);
    }
  }
  const traffic::VehicleState& state() const { return snapshot_.vehicles[0].state; }
  traffic::Vehicle& vehicle(std::size_t index) { return snapshot_.vehicles[index]; }
  double gap() const { return gap_; }
  double brakeTime() const { return brake_time_; }

 private:
  void step(const traffic::ControlAction& action) {
    traffic::Vehicle& ego = snapshot_.vehicles[0];
    const double before = ego.state.speed;
    ego.state = model_.step(ego.state, action, 0.05);
    ego.acceleration = (ego.state.speed - before) / 0.05;
    for (std::size_t i = 1; i < snapshot_.vehicles.size(); ++i) {
      traffic::Vehicle& other = snapshot_.vehicles[i];
      other.state.position += 0.05 * other.state.velocity();
      gap_ = std::min(gap_, geometry::distance(ego.box(), other.box()));
    }
    snapshot_.time += 0.05;
  }

  map::RoadNetwork network_ =
      testing::makeNetwork({{"road", testing::straight(0.0, 0.0, 200.0, 0.0)}});
  map::DrivableArea area_{network_};
  map::Route route_ = testing::routeAlong(network_, {"road"});
  dynamics::BicycleModelOptions dynamics_;
  dynamics::BicycleModel model_;
  rendering::CameraOptions camera_;
  guidance::GuidanceOptions guidance_;
  std::unique_ptr<planning::Planner> planner_;
  traffic::TrafficSnapshot snapshot_;
  double gap_ = 1e9;
  double brake_time_ = -1.0;
};

TEST(CarefulDriverPlanner, ReachesTheTargetSpeedAndStopsAtTheEnd) {
  Drive drive({}, 0.0);
  drive.run(8.0);
  EXPECT_NEAR(drive.state().speed, 8.0, 0.4);
  drive.run(30.0);
  EXPECT_EQ(drive.state().speed, 0.0);
  EXPECT_NEAR(drive.state().position.x(), 200.5, 1.5);
}

TEST(CarefulDriverPlanner, FollowsALeadInTheRegulationsDistance) {
  Drive drive;
  drive.add(testing::vehicleAt("lead", 40.0, 0.0, 0.0, 5.0));
  drive.run(20.0);
  EXPECT_NEAR(drive.state().speed, 5.0, 0.3);
  EXPECT_GE(drive.gap(), reference_driver::followingGap(5.0) - 0.3);
  EXPECT_LT(drive.brakeTime(), 0.0);
}

TEST(CarefulDriverPlanner, StopsBehindAStandingVehicle) {
  Drive drive;
  drive.add(testing::vehicleAt("parked", 80.0, 0.0, 0.0, 0.0));
  drive.run(45.0);
  EXPECT_LT(drive.state().speed, 0.1);
  EXPECT_GT(drive.gap(), 1.0);
  EXPECT_LT(drive.gap(), 4.0);
}

TEST(CarefulDriverPlanner, FollowsWhatStandsSeventyMetersAhead) {
  Drive alone;
  Drive behind;
  behind.add(testing::vehicleAt("parked", 80.0, 0.0, 0.0, 0.0));
  Drive far_behind;
  far_behind.add(testing::vehicleAt("parked", 110.0, 0.0, 0.0, 0.0));
  for (Drive* drive : {&alone, &behind, &far_behind}) drive->run(1.0);
  EXPECT_LT(behind.state().speed, alone.state().speed - 0.01);
  EXPECT_EQ(far_behind.state().speed, alone.state().speed);
}

// A car from the right at 8 m/s, 20 m beside the road, that can no longer yield: C
// brakes 1.2 s later on a grid of 0.1 s, fully after 0.6 s more; with a longer delay later or
// never.
TEST(CarefulDriverPlanner, BrakesForACrossingCarAfterItsDelay) {
  const auto brakes = [](const std::vector<std::string>& assignments) {
    Drive drive(assignments);
    drive.add(testing::vehicleAt("crossing", 34.0, -20.0, testing::kNorth, 8.0));
    drive.run(3.5);
    return drive;
  };
  const Drive careful = brakes({});
  EXPECT_NEAR(careful.brakeTime(), 1.2 + 0.6, 0.25);
  EXPECT_GT(careful.gap(), 0.3);
  const Drive late = brakes({"delay=1.25"});
  EXPECT_TRUE(late.brakeTime() < 0.0 || late.brakeTime() > careful.brakeTime() + 0.3);
}

TEST(CarefulDriverPlanner, HasOtherDriversThatBrakeForAStandingVehicle) {
  for (const char* driver : {"driver=rss", "driver=fuzzy"}) {
    Drive drive({driver});
    drive.add(testing::vehicleAt("parked", 60.0, 0.0, 0.0, 0.0));
    drive.run(20.0);
    EXPECT_GT(drive.gap(), 1.0) << driver;
    EXPECT_LT(drive.state().speed, 0.1) << driver;
  }
}

TEST(CarefulDriverPlanner, RefusesByNameWhatItCannotStopFor) {
  Drive drive({"top_speed=10", "horizon=3"});
  drive.vehicle(0).state.speed = 15.0;
  const planning::PlannedAction refused = drive.decide();
  EXPECT_EQ(refused.action, traffic::ControlAction::failSafe());
  EXPECT_NE(refused.fault.find("vehicle 'ego': from its 15 m/s it stops in"), std::string::npos);
  EXPECT_NE(refused.fault.find("key careful_driver.horizon"), std::string::npos);
  EXPECT_THROW(Drive({"horizon=3"}), core::InputError);
  EXPECT_THROW(Drive({"delay=-1"}), core::InputError);
  EXPECT_NO_THROW(Drive({"deceleration=2"}));
}

}  // namespace
}  // namespace cdiff::planners
