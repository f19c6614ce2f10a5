// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Conditions and actions on a straight lane along x, with an ego that a planner drives and a car.
#include <gtest/gtest.h>

#include "storyboard/traffic_stage.h"
#include "support/sumo_network.h"

namespace cdiff::storyboard {
namespace {

using Measure = EntityCondition::Measure;

constexpr double kStep = 0.05;    // [s]
constexpr double kMiddle = -1.6;  // y of the lane [m]

Scenario egoAndCar() {
  Scenario scenario;
  for (const char* name : {"ego", "car"}) {
    Entity entity;
    entity.name = name;
    entity.dimensions = {4.0, 2.0, 1.5};
    scenario.entities.push_back(entity);
  }
  return scenario;
}

TeleportAction placeAt(double x) {
  TeleportAction action;
  action.to.point = {x, kMiddle, 0.0};
  return action;
}

SpeedAction speedOf(double value) {
  SpeedAction action;
  action.value = value;
  return action;
}

class StoryboardTrafficStage : public testing::Test {
 protected:
  template <class What>
  std::shared_ptr<Performance> begin(const What& what) {
    return stage_.begin({"", {"file.xosc", 1}, what}, {"car"}, time_).front();
  }
  /// Whether what is measured of the ego is at least this.
  bool holds(Measure measure, double value) {
    EntityCondition measured;
    measured.entities = {"ego"};
    measured.measure = measure;
    measured.rule = Rule::kGreaterOrEqual;
    measured.value = value;
    Condition condition;
    condition.what = measured;
    return stage_.holds(condition, time_);
  }
  void observe(double x, double speed) {
    traffic::VehicleState state;
    state.position = {x, kMiddle};
    state.speed = speed;
    stage_.observe("ego", state, nullptr, kStep);
  }
  void drive(double seconds) {
    for (int i = 0; i < static_cast<int>(std::lround(seconds / kStep)); ++i) {
      time_ += kStep;
      stage_.advance(time_, kStep);
    }
  }
  test::TemporaryFolder folder_;
  test::SumoNetwork net_ =
      test::makeSumoNetwork(folder_, R"(<node id="a" x="0" y="0"/><node id="b" x="900" y="0"/>)",
                            R"(<edge id="e" from="a" to="b" numLanes="1" speed="20"/>)");
  map::LaneGraph graph_{net_.network};
  Places places_{graph_, std::nullopt};
  Scenario scenario_ = egoAndCar();
  TrafficStage stage_{scenario_, places_, {"ego"}};
  double time_ = 0.0;
};

TEST_F(StoryboardTrafficStage, WhatPlannersDriveIsMeasured) {
  observe(10.0, 2.0);
  observe(10.1, 2.1);
  EXPECT_TRUE(holds(Measure::kTraveledDistance, 0.1));
  EXPECT_FALSE(holds(Measure::kTraveledDistance, 0.2));
  EXPECT_TRUE(holds(Measure::kAcceleration, 2.0));  // 0.1 m/s in 0.05 s
  EXPECT_FALSE(holds(Measure::kAcceleration, 2.1));
  observe(10.1, 0.0);
  observe(10.1, 0.0);
  EXPECT_TRUE(holds(Measure::kStandStill, 0.1));
  EXPECT_FALSE(holds(Measure::kStandStill, 0.2));
}

TEST_F(StoryboardTrafficStage, ACollisionIsKnownUntilTheNextMoveAfterARemoval) {
  observe(10.0, 2.0);
  begin(placeAt(20.0));
  EXPECT_FALSE(holds(Measure::kCollision, 0.0));
  observe(17.0, 2.0);  // boxes are 4 m long
  stage_.remove("car");
  EXPECT_TRUE(holds(Measure::kCollision, 0.0));
  drive(kStep);
  EXPECT_FALSE(holds(Measure::kCollision, 0.0));
}

TEST_F(StoryboardTrafficStage, PlacesComeBeforeTheOtherActionsOfTheBeginning) {
  scenario_.init.push_back({"car", {"", {"file.xosc", 1}, speedOf(8.0)}});
  scenario_.init.push_back({"car", {"", {"file.xosc", 2}, placeAt(20.0)}});
  stage_.begin();
  EXPECT_EQ(stage_.actor("car").speed(), 8.0);
}

TEST_F(StoryboardTrafficStage, ADistanceIsKeptUntilItIsReached) {
  observe(100.0, 0.0);
  begin(placeAt(20.0));
  begin(speedOf(12.0));
  DistanceAction distance;
  distance.entity = "ego";
  distance.value = 50.0;  // 30 m less than now, so 12 m/s is the speed to begin with
  const auto performing = begin(distance);
  drive(2.0);
  EXPECT_FALSE(performing->over);
  for (int i = 0; i < 600 && !performing->over; ++i) drive(kStep);
  EXPECT_TRUE(performing->over);
  EXPECT_NEAR(stage_.actor("car").reference().pose.position.x(), 50.0, 0.15);
}

}  // namespace
}  // namespace cdiff::storyboard
