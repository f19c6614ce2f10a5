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
  /// The car at 20 m, the ego at 100 m, with these speeds [m/s].
  void driveBehindEgo(double speed, double ego_speed) {
    observe(100.0, ego_speed);
    begin(placeAt(20.0));
    begin(speedOf(speed));
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
  driveBehindEgo(12.0, 0.0);
  DistanceAction distance;
  distance.entity = "ego";
  distance.limits = SpeedLimits{};
  distance.value = 50.0;  // 30 m less than now, so 12 m/s is the speed to begin with
  const auto performing = begin(distance);
  drive(2.0);
  EXPECT_FALSE(performing->over);
  for (int i = 0; i < 600 && !performing->over; ++i) drive(kStep);
  EXPECT_TRUE(performing->over);
  EXPECT_NEAR(stage_.actor("car").reference().pose.position.x(), 50.0, 0.15);
}

TEST_F(StoryboardTrafficStage, WithoutLimitsADistanceIsThereAtOnce) {
  observe(100.0, 10.0);
  begin(placeAt(20.0));
  DistanceAction distance;
  distance.entity = "ego";
  distance.time_gap = true;
  distance.freespace = true;
  distance.value = 2.0;
  distance.side = Side::kAheadOrLeft;
  EXPECT_TRUE(begin(distance)->over);
  // 2 s of the ego's 10 m/s, and boxes of 4 m.
  EXPECT_NEAR(stage_.actor("car").reference().pose.position.x(), 124.0, 1e-6);
}

TEST_F(StoryboardTrafficStage, AFreeSpaceIsKeptAlsoFromAbreast) {
  observe(100.0, 10.0);
  begin(placeAt(100.1));
  DistanceAction distance;
  distance.entity = "ego";
  distance.freespace = true;
  distance.value = 10.0;
  distance.side = Side::kAheadOrLeft;
  EXPECT_TRUE(begin(distance)->over);
  EXPECT_NEAR(stage_.actor("car").reference().pose.position.x(), 114.0, 1e-6);  // boxes of 4 m
}

TEST_F(StoryboardTrafficStage, ADistanceAlongTheLaneIsKeptToo) {
  observe(100.0, 10.0);
  begin(placeAt(20.0));
  DistanceAction distance;
  distance.entity = "ego";
  distance.along_lanes = true;
  distance.value = 30.0;
  EXPECT_TRUE(begin(distance)->over);
  EXPECT_NEAR(stage_.actor("car").reference().pose.position.x(), 70.0, 1e-6);
  begin(placeAt(150.0));  // the line that it follows begins there, behind the ego
  distance.side = Side::kAheadOrLeft;
  distance.value = 70.0;
  EXPECT_TRUE(begin(distance)->over);
  EXPECT_NEAR(stage_.actor("car").reference().pose.position.x(), 170.0, 1e-6);
}

// One drives off the lanes in the midst of a session: that is nothing wrong with the file.
TEST_F(StoryboardTrafficStage, APlaceBesideOneThatIsOnNoLaneIsNotReached) {
  begin(placeAt(20.0));
  EntityCondition near;
  near.entities = {"car"};
  near.measure = Measure::kDistance;
  near.rule = Rule::kLess;
  near.value = 50.0;
  near.place.emplace();
  near.place->kind = Position::Kind::kRelativeLane;
  near.place->entity = "ego";
  Condition condition;
  condition.what = near;
  observe(40.0, 10.0);
  EXPECT_TRUE(stage_.holds(condition, time_));
  traffic::VehicleState off;
  off.position = {40.0, 60.0};
  stage_.observe("ego", off, nullptr, kStep);
  EXPECT_FALSE(stage_.holds(condition, time_));
}

TEST_F(StoryboardTrafficStage, WhoStandsHasAnEndlessHeadway) {
  begin(placeAt(20.0));
  observe(10.0, 0.0);
  EntityCondition headway;
  headway.entities = {"ego"};
  headway.other = "car";
  headway.measure = Measure::kHeadway;
  headway.rule = Rule::kGreater;
  headway.value = 100.0;
  Condition condition;
  condition.what = headway;
  EXPECT_TRUE(stage_.holds(condition, time_));
}

// The car is at 120 m. The ego is 90 m behind it, where the car's route has not begun, and 1 m to
// the right.
TEST_F(StoryboardTrafficStage, WhoIsBehindIsMeasuredAlongTheLanesToo) {
  begin(placeAt(120.0));
  traffic::VehicleState state;
  state.position = {30.0, kMiddle - 1.0};
  stage_.observe("ego", state, nullptr, kStep);
  EntityCondition distance;
  distance.entities = {"car"};
  distance.other = "ego";
  distance.measure = Measure::kDistance;
  distance.rule = Rule::kGreaterOrEqual;
  distance.lane_frame = true;
  Condition condition;
  for (const auto& [along, expected] : {std::pair(EntityCondition::Along::kLongitudinal, 90.0),
                                        std::pair(EntityCondition::Along::kLateral, 1.0)}) {
    distance.along = along;
    distance.value = expected - 0.01;
    condition.what = distance;
    EXPECT_TRUE(stage_.holds(condition, time_)) << expected;
    distance.value = expected + 0.01;
    condition.what = distance;
    EXPECT_FALSE(stage_.holds(condition, time_)) << expected;
  }
}

// Reference points in the middle of boxes of 4 m: from 20 m to 50 m, 28 m are free.
TEST_F(StoryboardTrafficStage, TheFreeSpaceToAPlaceIsThatOfTheBox) {
  begin(placeAt(20.0));
  EntityCondition distance;
  distance.entities = {"car"};
  distance.place = placeAt(50.0).to;
  distance.measure = Measure::kDistance;
  distance.rule = Rule::kLess;
  distance.freespace = true;
  Condition condition;
  for (const auto along :
       {EntityCondition::Along::kStraight, EntityCondition::Along::kLongitudinal}) {
    distance.along = along;
    distance.value = 28.01;
    condition.what = distance;
    EXPECT_TRUE(stage_.holds(condition, time_));
    distance.value = 27.99;
    condition.what = distance;
    EXPECT_FALSE(stage_.holds(condition, time_));
  }
}

TEST_F(StoryboardTrafficStage, ACollisionMayAskForAKind) {
  observe(10.0, 2.0);
  begin(placeAt(12.0));
  EntityCondition touch;
  touch.entities = {"ego"};
  touch.measure = Measure::kCollision;
  Condition condition;
  for (const auto& [kind, expected] :
       {std::pair(Entity::Kind::kPedestrian, false), std::pair(Entity::Kind::kVehicle, true)}) {
    touch.other_kinds = {kind};
    condition.what = touch;
    EXPECT_EQ(stage_.holds(condition, time_), expected);
  }
}

TEST_F(StoryboardTrafficStage, ADistanceIsKeptWithinTheLimits) {
  driveBehindEgo(10.0, 30.0);
  DistanceAction distance;
  distance.entity = "ego";
  distance.continuous = true;
  distance.limits = SpeedLimits{2.0, 2.0, 15.0};
  begin(distance);
  drive(1.0);
  EXPECT_NEAR(stage_.actor("car").speed(), 12.0, 1e-9);  // 2 m/s^2
  drive(5.0);
  EXPECT_EQ(stage_.actor("car").speed(), 15.0);
}

TEST_F(StoryboardTrafficStage, ALateralDistanceIsKeptAtItsSpeed) {
  driveBehindEgo(10.0, 10.0);
  LateralDistanceAction beside;
  beside.entity = "ego";
  beside.value = 0.5;
  beside.freespace = true;
  beside.side = Side::kBehindOrRight;
  beside.speed = 1.0;
  const auto performing = begin(beside);
  drive(1.0);
  EXPECT_NEAR(stage_.actor("car").reference().pose.position.y(), kMiddle - 1.0, 1e-6);
  EXPECT_FALSE(performing->over);
  drive(2.0);
  EXPECT_NEAR(stage_.actor("car").reference().pose.position.y(), kMiddle - 2.5, 1e-6);
  EXPECT_TRUE(performing->over);  // 0.5 m between boxes of 2 m
}

TEST_F(StoryboardTrafficStage, ASpeedProfileGoesThroughItsSpeeds) {
  begin(placeAt(20.0));
  SpeedProfileAction profile;
  const auto part = [](double speed, Dynamics::Dimension dimension, double value) {
    SpeedAction action = speedOf(speed);
    action.dynamics = {Dynamics::Shape::kLinear, dimension, value};
    return action;
  };
  profile.parts = {part(2.0, Dynamics::Dimension::kTime, 0.0),
                   part(6.0, Dynamics::Dimension::kTime, 2.0),
                   part(0.0, Dynamics::Dimension::kRate, 3.0)};
  const auto performing = begin(profile);
  EXPECT_EQ(stage_.actor("car").speed(), 2.0);
  drive(1.0);
  EXPECT_NEAR(stage_.actor("car").speed(), 4.0, 1e-9);
  drive(2.0);
  EXPECT_NEAR(stage_.actor("car").speed(), 3.0, 1e-9);  // 2 s to 6 m/s, then 1 s at -3 m/s^2
  EXPECT_FALSE(performing->over);
  drive(1.0);
  EXPECT_TRUE(performing->over);
}

TEST_F(StoryboardTrafficStage, TwoMeetInTimeAndWithTheFinalSpeed) {
  begin(placeAt(20.0));
  begin(speedOf(8.0));
  SynchronizeAction meeting;
  meeting.master = "ego";
  meeting.master_target.point = {200.0, kMiddle, 0.0};
  meeting.target.point = {150.0, kMiddle, 0.0};
  meeting.final_speed = speedOf(10.0);
  double ego = 100.0;  // 10 s of 10 m/s before its target
  observe(ego, 10.0);
  const auto performing = begin(meeting);
  for (int i = 0; i < 400 && !performing->over; ++i) {
    drive(kStep);
    ego += 10.0 * kStep;
    observe(ego, 10.0);
  }
  EXPECT_TRUE(performing->over);
  EXPECT_NEAR(ego, 199.0, 1.5);
  EXPECT_NEAR(stage_.actor("car").reference().pose.position.x(), 149.0, 1.5);
  EXPECT_NEAR(stage_.actor("car").speed(), 10.0, 1.0);
}

TEST_F(StoryboardTrafficStage, WithoutAFinalSpeedTheSpeedStays) {
  begin(placeAt(20.0));
  begin(speedOf(13.0));
  SynchronizeAction meeting;
  meeting.master = "ego";
  meeting.master_target.point = {200.0, kMiddle, 0.0};
  meeting.target.point = {150.0, kMiddle, 0.0};
  observe(100.0, 10.0);  // 10 s to its target; the car has 130 m to go
  begin(meeting);
  drive(kStep);
  EXPECT_NEAR(stage_.actor("car").speed(), 13.0, 1e-6);
}

TEST_F(StoryboardTrafficStage, TheTimeOffTheRoadAndAtItsEndIsMeasured) {
  observe(100.0, 10.0);
  observe(100.5, 10.0);
  EXPECT_FALSE(holds(Measure::kOffroad, 0.0));
  traffic::VehicleState beside;
  beside.position = {101.0, kMiddle + 20.0};
  for (int i = 0; i < 4; ++i) stage_.observe("ego", beside, nullptr, kStep);
  EXPECT_TRUE(holds(Measure::kOffroad, 0.2));
  EXPECT_FALSE(holds(Measure::kOffroad, 0.25));
  EXPECT_FALSE(holds(Measure::kEndOfRoad, 0.0));
  observe(899.8, 10.0);
  EXPECT_TRUE(holds(Measure::kEndOfRoad, 0.05));
  EXPECT_FALSE(holds(Measure::kOffroad, 0.0));
}

TEST_F(StoryboardTrafficStage, APositionOnARouteCountsAlongIt) {
  TeleportAction action;
  action.to.kind = Position::Kind::kRoute;
  action.to.route = {placeAt(50.0).to, placeAt(150.0).to};
  action.to.s = 30.0;
  action.to.t = 0.5;
  begin(action);
  EXPECT_NEAR(stage_.actor("car").reference().pose.position.x(), 80.0, 1e-6);
  EXPECT_NEAR(stage_.actor("car").reference().pose.position.y(), kMiddle + 0.5, 1e-6);
}

TEST_F(StoryboardTrafficStage, ARouteGoesOnFromTheWaypointThatIsPassed) {
  begin(placeAt(80.0));
  begin(RouteAction{{placeAt(50.0).to, placeAt(150.0).to}});
  begin(speedOf(10.0));
  drive(1.0);
  EXPECT_NEAR(stage_.actor("car").reference().pose.position.x(), 90.0, 1e-6);
}

TEST_F(StoryboardTrafficStage, AClothoidIsFollowedBetweenItsTimes) {
  begin(placeAt(20.0));
  FollowTrajectoryAction course;
  course.clothoid = Clothoid{0.0, 0.0, 40.0};
  course.timed = true;
  course.vertices = {{0.0, placeAt(20.0).to}, {4.0, placeAt(20.0).to}};
  const auto performing = begin(course);
  drive(2.0);
  EXPECT_NEAR(stage_.actor("car").reference().pose.position.x(), 40.0, 1e-6);
  EXPECT_FALSE(performing->over);
  drive(2.0);
  EXPECT_NEAR(stage_.actor("car").reference().pose.position.x(), 60.0, 1e-6);
  EXPECT_TRUE(performing->over);
}

TEST_F(StoryboardTrafficStage, ASplineIsFollowedAtTheSpeed) {
  begin(placeAt(20.0));
  begin(speedOf(10.0));
  FollowTrajectoryAction course;
  course.spline = Spline{2, {1.0, 1.0}, {0.0, 0.0, 1.0, 1.0}};
  course.vertices = {{0.0, placeAt(20.0).to}, {0.0, placeAt(50.0).to}};
  course.vertices.back().position.point.y() = kMiddle + 40.0;  // 50 m away
  begin(course);
  drive(2.0);
  EXPECT_NEAR(stage_.actor("car").reference().pose.position.x(), 32.0, 1e-6);
  EXPECT_NEAR(stage_.actor("car").reference().pose.position.y(), kMiddle + 16.0, 1e-6);
  EXPECT_NEAR(stage_.actor("car").reference().pose.heading, std::atan2(40.0, 30.0), 1e-6);
}

}  // namespace
}  // namespace cdiff::storyboard
