// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <vector>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/geometry/shapes.h"
#include "planning/plan_tracker.h"

namespace cdiff::planning {
namespace {

/// Places of a plan along +x at a constant speed.
Eigen::MatrixX2d ahead(double speed, Eigen::Index rows = 32) {
  Eigen::MatrixX2d places = Eigen::MatrixX2d::Zero(rows, 2);
  for (Eigen::Index row = 0; row < rows; ++row)
    places(row, 0) = 0.1 * speed * static_cast<double>(row + 1);
  return places;
}

/// With what is published for Pluto and RIFT.
PlanTracker published() { return PlanTracker(PlanTrackerOptions::published()); }

/// Places 0.8 m apart that aims are taken from one by one, the steering being the turn error
/// itself.
PlanTrackerOptions fine() {
  PlanTrackerOptions options;
  options.pids.turn = {1.0, 0.0, 0.0};
  options.aim_period = 0.1;
  options.look_ahead_time = 0.5;
  options.look_ahead_distance = 1.0;
  options.look_ahead_minimum = 4.0;
  options.look_ahead_maximum = 8.0;
  options.speed_horizon = 1.0;
  options.steer_while_braking = true;
  return options;
}

TEST(PublishedTracker, FirstSpeedErrorIsTheSumOfAllThreeTerms) {
  // Places 8, 16, 24 m: desired 8 m/s. Error 0.1: 5 x 0.1 + 0.5 x 0.1 / 20 + 1 x 0.1 = 0.6025.
  PlanTracker tracker = published();
  const traffic::ControlAction first = tracker.track(7.9, ahead(8.0));
  EXPECT_NEAR(first.throttle, 0.6025, 1e-12);
  EXPECT_EQ(first.brake, 0.0);
  EXPECT_EQ(first.steer, 0.0);
  // The same again: no change, mean 0.2 / 20: 0.5 + 0.005.
  EXPECT_NEAR(tracker.track(7.9, ahead(8.0)).throttle, 0.505, 1e-12);
}

TEST(PublishedTracker, DesiredSpeedIsThatOfWholeSeconds) {
  // Standing still after 1 s at 6 m/s: places 6, 6, 6 m, desired 6 / 3 = 2 m/s.
  Eigen::MatrixX2d places = ahead(6.0);
  places.bottomRows(22).col(0).setConstant(6.0);
  EXPECT_EQ(published().track(2.19, places).brake, 0.0);
  EXPECT_EQ(published().track(2.21, places).brake, 1.0);
  // What lies after the last whole second does not count.
  places.bottomRows(2).col(0).setConstant(60.0);
  EXPECT_EQ(published().track(2.21, places).brake, 1.0);
}

TEST(DesiredSpeed, IsTheMeanOverItsHorizon) {
  // 6 m/s for 1 s, then standing: 6 m in 1, 2 and 3 s. A horizon of 1.9 s has one whole second.
  Eigen::MatrixX2d places = ahead(6.0);
  places.bottomRows(22).col(0).setConstant(6.0);
  EXPECT_NEAR(desiredSpeed(places, 1.0), 6.0, 1e-12);
  EXPECT_NEAR(desiredSpeed(places, 1.9), 6.0, 1e-12);
  EXPECT_NEAR(desiredSpeed(places, 2.0), 3.0, 1e-12);
  EXPECT_NEAR(desiredSpeed(places, 60.0), 2.0, 1e-12);
  EXPECT_EQ(desiredSpeed(ahead(6.0, 0), 3.0), 0.0);
  // From a vehicle 3 m behind the plan's start: 9 m in the first second.
  const std::vector<Eigen::Vector2d> rows(10, Eigen::Vector2d(6.0, 0.0));
  EXPECT_NEAR(desiredSpeed({-3.0, 0.0}, {rows.data(), rows.size()}, 1.0), 9.0, 1e-12);
}

TEST(PublishedTracker, ShortPlansCountHalfSeconds) {
  // 19 rows of 4 m/s that stop after 1 s: places 2, 4, 4 m; desired 4 m in 1.5 s = 2.667 m/s, brake
  // above 2.933 m/s. By whole seconds it would be 4 m/s.
  Eigen::MatrixX2d places = ahead(4.0, 19);
  places.bottomRows(9).col(0).setConstant(4.0);
  EXPECT_EQ(published().track(2.93, places).brake, 0.0);
  EXPECT_EQ(published().track(2.94, places).brake, 1.0);
  // A plan of 0.2 s is one segment: 0.8 m in 0.2 s. One without rows is a stop.
  EXPECT_EQ(published().track(4.3, ahead(4.0, 2)).brake, 0.0);
  EXPECT_EQ(published().track(4.5, ahead(4.0, 2)).brake, 1.0);
  EXPECT_EQ(published().track(0.0, ahead(4.0, 0)), traffic::ControlAction::failSafe());
}

TEST(PublishedTracker, AimsAtThePlaceNearestToTheLookAhead) {
  // At 4 m/s the look-ahead is its minimum, 5 m: of 4, 8 and 12 m the first, 0.4 m to the left of
  // it. atan(0.4 / 4) / (pi / 2) = 0.0634510; x (1.25 + 0.75 / 20 + 0.3) = 0.1007285.
  Eigen::MatrixX2d places = ahead(4.0);
  places(9, 1) = 0.4;
  places(19, 1) = -3.0;
  EXPECT_NEAR(published().track(4.0, places).steer, 0.1007285, 1e-7);
  // At 10 m/s it is 7.5 m, but of 10, 20 and 30 m still the first.
  places = ahead(10.0);
  places(9, 1) = -1.0;
  EXPECT_NEAR(published().track(10.0, places).steer, -0.1007285, 1e-7);
  // At 2.2 m/s, 5 m: the second of 2.2, 4.4 and 6.6 m.
  places = ahead(2.2);
  places(19, 1) = 0.44;
  EXPECT_NEAR(published().track(2.2, places).steer, 0.1007285, 1e-7);
}

TEST(PlanTracker, AimsAtPlacesAsFarApartAsAsked) {
  // At 8 m/s clamp(0.5 x 8 + 1, 4, 8) = 5 m: of 4.8 and 5.6 m the first, row 5, which alone lies to
  // the left: atan(0.48 / 4.8) / (pi / 2) = 0.0634510.
  Eigen::MatrixX2d places = ahead(8.0);
  places(5, 1) = 0.48;
  EXPECT_NEAR(PlanTracker(fine()).track(8.0, places).steer, 0.0634510, 1e-7);
  // With places 0.5 s apart 4 and 8 m: row 4, straight ahead; 1 s apart 8 m.
  PlanTrackerOptions options = fine();
  options.aim_period = 0.5;
  EXPECT_EQ(PlanTracker(options).track(8.0, places).steer, 0.0);
  places(4, 1) = -0.4;
  EXPECT_NEAR(PlanTracker(options).track(8.0, places).steer, -0.0634510, 1e-7);
  options.aim_period = 1.0;
  places(9, 1) = 0.8;
  EXPECT_NEAR(PlanTracker(options).track(8.0, places).steer, 0.0634510, 1e-7);
}

TEST(PlanTracker, APlanThatComesBackDoesNotDrawTheAimAway) {
  // 5 m at 8 m/s: row 5 (4.8 m), though the last place lies 5 m to the left, exactly as far.
  Eigen::MatrixX2d places = ahead(8.0);
  places.row(31) << 0.0, 5.0;
  EXPECT_EQ(PlanTracker(fine()).track(8.0, places).steer, 0.0);
}

TEST(PlanTracker, AimsAtTheFarthestPlaceOfAPlanThatEndsBefore) {
  // 4 m at 2 m/s; the plan ends after 1.6 m, 0.16 m to the left.
  Eigen::MatrixX2d places = ahead(2.0);
  places.bottomRows(24).rowwise() = Eigen::RowVector2d(1.6, 0.16);
  EXPECT_NEAR(PlanTracker(fine()).track(1.0, places).steer, 0.0634510, 1e-7);
  // One that goes less than 1 m has no direction.
  EXPECT_EQ(PlanTracker(fine()).track(1.0, 0.6 * places).steer, 0.0);
}

TEST(PlanTracker, SteersWhileItBrakesIfAsked) {
  Eigen::MatrixX2d places = ahead(4.0);
  places.col(1).setConstant(2.0);
  EXPECT_GT(published().track(4.0, places).steer, 0.0);
  EXPECT_EQ(published().track(8.0, places).steer, 0.0);
  EXPECT_EQ(published().track(0.009, places).steer, 0.0);
  const traffic::ControlAction action = PlanTracker(fine()).track(8.0, places);
  EXPECT_EQ(action.brake, 1.0);
  // 5 m at 8 m/s: row 10 lies at hypot(4.4, 2) = 4.83 m, row 11 at hypot(4.8, 2) = 5.2 m:
  // atan(2 / 4.4) / (pi / 2) = 0.2716.
  EXPECT_NEAR(action.steer, 0.2716, 1e-4);
  EXPECT_EQ(PlanTracker(fine()).track(0.009, places).steer, 0.0);
}

TEST(PlanTracker, AnyFrameGivesTheSameAction) {
  // The same plan in a frame turned by 90 degrees and shifted.
  Eigen::MatrixX2d places = ahead(6.0);
  places(6, 1) = 0.5;
  std::vector<Eigen::Vector2d> moved;
  const geometry::Pose2d pose{{3.0, -2.0}, 0.5 * core::kPi};
  for (const auto& place : places.rowwise()) moved.push_back(pose.toMap(place.transpose()));
  const PlanFollower vehicle{pose.position, geometry::direction(pose.heading), 5.0};
  const traffic::ControlAction there =
      PlanTracker(fine()).track(vehicle, {moved.data(), moved.size()});
  const traffic::ControlAction here = PlanTracker(fine()).track(5.0, places);
  EXPECT_NEAR(there.steer, here.steer, 1e-12);
  EXPECT_NEAR(there.throttle, here.throttle, 1e-9);
  EXPECT_NE(here.steer, 0.0);
}

TEST(PlanTrackerOptions, LookAheadLimitsOutOfOrderAreAnError) {
  PlanTrackerOptions options;
  options.look_ahead_minimum = 9.0;
  EXPECT_THROW(PlanTracker{options}, core::InputError);
  EXPECT_THROW(PlanTrackerOptions::named("tunde"), core::InputError);
}

TEST(PlanTrackerOptions, ReadBackFromTheirOwnText) {
  PlanTrackerOptions options;
  options.pids.turn.kp = 0.77;
  options.pids.window = 40;
  PlanTrackerOptions read = PlanTrackerOptions::published();
  core::loadOptions({"text", core::dumpOptions(options, true)}, read);
  EXPECT_EQ(read.pids.turn.kp, 0.77);
  EXPECT_EQ(core::dumpOptions(read), core::dumpOptions(options));
}

// Naming a tracker sets all its values; single keys go on top, whatever their order in the file.
TEST(PlanTrackerOptions, ANameSetsAllKeysBelowSingleOnes) {
  PlanTrackerOptions options;
  options.aim_period = 0.3;
  core::loadOptions({"text", "turn_kp: 2\ntracker: published\n"}, options);
  EXPECT_EQ(options.aim_period, 1.0);
  EXPECT_EQ(options.look_ahead_distance, 2.5);
  EXPECT_EQ(options.speed_horizon, 8.0);
  EXPECT_FALSE(options.steer_while_braking);
  EXPECT_EQ(options.pids.turn.kp, 2.0);
  EXPECT_EQ(options.pids.turn.kd, 0.3);
  // The name that it has already changes nothing.
  core::overrideOption("tracker=published", "--set", options);
  EXPECT_EQ(options.pids.turn.kp, 2.0);
  core::overrideOption("tracker=tuned", "--set", options);
  EXPECT_EQ(core::dumpOptions(options), core::dumpOptions(PlanTrackerOptions()));
}

TEST(PlanTrackerOptions, TheGroupThatTheKeysWereInIsAnErrorThatNamesThem) {
  PlanTrackerOptions options;
  try {
    core::loadOptions({"s.yaml", "tracker:\n  turn_kp: 2\n"}, options);
    FAIL();
  } catch (const core::InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("expected one of {tuned, published}"), std::string::npos) << text;
    EXPECT_NE(text.find("keys beside it"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace cdiff::planning
