// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <functional>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/dynamics/bicycle_model.h"
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

/// The vehicle at each decision; every 0.1 s it tracks a plan along a path at constant speed from
/// the foot point of where it is.
class TrackerLoop {
 public:
  /// `arc_of`: arc length of the foot point of a place; `at`: place at an arc length; map frame.
  TrackerLoop(std::function<double(const Eigen::Vector2d&)> arc_of,
              std::function<Eigen::Vector2d(double)> at)
      : arc_of_(std::move(arc_of)), at_(std::move(at)) {}

  void run(double seconds, double speed, const std::function<void()>& check) {
    for (int i = 0; i < std::lround(seconds / 0.1); ++i) {
      Eigen::MatrixX2d places(32, 2);
      for (Eigen::Index row = 0; row < 32; ++row) {
        const double arc = arc_of_(state.position) + 0.1 * speed * static_cast<double>(row + 1);
        places.row(row) = state.pose().toBody(at_(arc)).transpose();
      }
      state = model_.step(state, tracker_.track(state.speed, places), 0.1);
      check();
    }
  }

  traffic::VehicleState state;

 private:
  std::function<double(const Eigen::Vector2d&)> arc_of_;
  std::function<Eigen::Vector2d(double)> at_;
  PlanTracker tracker_ = published();
  dynamics::BicycleModel model_;
};

TrackerLoop straightLoop() {
  return {[](const Eigen::Vector2d& place) { return place.x(); },
          [](double arc) { return Eigen::Vector2d(arc, 0.0); }};
}

TEST(TrackerLoop, FollowsAStraightPlanFromAside) {
  TrackerLoop loop = straightLoop();
  loop.state.position.y() = 0.5;
  loop.state.speed = 4.0;
  double elapsed = 0.0;
  double furthest = 0.0;
  loop.run(20.0, 8.0, [&] {
    elapsed += 0.1;
    if (elapsed < 10.0) return;
    furthest = std::max(furthest, std::abs(loop.state.position.y()));
    // No error of 0.1 m/s stays: its throttle, 0.5 or more, accelerates by 0.45 m/s^2 at 8 m/s.
    // Without error the mean alone gives at most 0.5, so at most 0.05 m/s on top of 1.1 x 8 m/s,
    // above which it brakes, in 0.1 s by 0.8 m/s, to no less than 8 m/s.
    EXPECT_GT(loop.state.speed, 7.9);
    EXPECT_LT(loop.state.speed, 1.1 * 8.0 + 0.05);
  });
  // To first order, the mean taken as a gain and slip left out, heading' = -2.83 (heading + y / 8)
  // and y' = 8 heading: poles of real part -1.4 / s, so nothing is left of 0.5 m after 10 s. 1 %
  // allows for the delay of the mean (2 s) and the slower start.
  EXPECT_LT(furthest, 0.005);
}

TEST(TrackerLoop, CutsACurveByTheDerivedAmount) {
  // Circle of 30 m to the left at 6 m/s. The vehicle's center moves along heading + slip with
  // sin(slip) = l_r / R = 1.4178 / 30, slip 0.0473; it takes steer = atan(l / l_r tan(slip)) /
  // 0.3685 = atan(0.93598 x 0.04731) / 0.3685 = 0.1201, and with P and the mean (1.25 + 0.75) e =
  // 0.1201 a bearing of 0.06005 x pi / 2 = 0.0943 rad. The aim, 6 m along the arc, is 0.1 rad left
  // of the tangent and so 0.1473 rad left of the heading: the vehicle runs (0.1473 - 0.0943) x 6 m
  // = 0.32 m inside, to first order in 6 m / R; the second order is 0.2 of it at most.
  const double radius = 30.0;
  const Eigen::Vector2d center(0.0, radius);
  TrackerLoop loop(
      [&](const Eigen::Vector2d& place) {
        const Eigen::Vector2d offset = place - center;
        return radius * std::atan2(offset.x(), -offset.y());
      },
      [&](double arc) {
        return Eigen::Vector2d(
            center + radius * Eigen::Vector2d(std::sin(arc / radius), -std::cos(arc / radius)));
      });
  loop.state.speed = 6.0;
  double elapsed = 0.0;
  loop.run(30.0, 6.0, [&] {
    elapsed += 0.1;
    const double inside = radius - (loop.state.position - center).norm();
    if (elapsed < 10.0) return;
    EXPECT_NEAR(inside, 0.32, 0.064) << elapsed;
  });
}

TEST(TrackerLoop, StandsAfterAStoppingPlan) {
  TrackerLoop loop = straightLoop();
  loop.state.speed = 8.0;
  // Full braking is 8 m/s^2 down to 0.5 m/s: 8^2 / (2 x 8) = 4 m, Euler's 8 x 0.05 / 2 = 0.2 m and
  // less than 0.1 m while the last 0.5 m/s fade.
  loop.run(2.0, 0.0, [] {});
  EXPECT_EQ(loop.state.speed, 0.0);
  EXPECT_GE(loop.state.position.x(), 4.0);
  EXPECT_LE(loop.state.position.x(), 4.3);
  // It starts again when the plan does.
  loop.run(2.0, 4.0, [] {});
  EXPECT_GT(loop.state.speed, 1.0);
}

}  // namespace
}  // namespace cdiff::planning
