// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <functional>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/dynamics/bicycle_model.h"
#include "planners/two_stage_pid/two_stage_pid.h"

namespace cdiff::planners {
namespace {

/// Places of a plan along +x at a constant speed.
Eigen::MatrixX2d ahead(double speed, Eigen::Index rows = 32) {
  Eigen::MatrixX2d places = Eigen::MatrixX2d::Zero(rows, 2);
  for (Eigen::Index row = 0; row < rows; ++row)
    places(row, 0) = 0.1 * speed * static_cast<double>(row + 1);
  return places;
}

TEST(TrajectoryTracker, FirstSpeedErrorIsTheSumOfAllThreeTerms) {
  // Places 8, 16, 24 m: desired 8 m/s. Error 0.1: 5 x 0.1 + 0.5 x 0.1 / 20 + 1 x 0.1 = 0.6025.
  TrajectoryTracker tracker;
  const traffic::ControlAction first = tracker.track(7.9, ahead(8.0));
  EXPECT_NEAR(first.throttle, 0.6025, 1e-12);
  EXPECT_EQ(first.brake, 0.0);
  EXPECT_EQ(first.steer, 0.0);
  // The same again: no change, mean 0.2 / 20: 0.5 + 0.005.
  EXPECT_NEAR(tracker.track(7.9, ahead(8.0)).throttle, 0.505, 1e-12);
}

TEST(TrajectoryTracker, DesiredSpeedIsThatOfWholeSeconds) {
  // Standing still after 1 s at 6 m/s: places 6, 6, 6 m, desired 6 / 3 = 2 m/s.
  Eigen::MatrixX2d places = ahead(6.0);
  places.bottomRows(22).col(0).setConstant(6.0);
  EXPECT_EQ(TrajectoryTracker().track(2.19, places).brake, 0.0);
  EXPECT_EQ(TrajectoryTracker().track(2.21, places).brake, 1.0);
  // What lies after the last whole second does not count.
  places.bottomRows(2).col(0).setConstant(60.0);
  EXPECT_EQ(TrajectoryTracker().track(2.21, places).brake, 1.0);
}

TEST(TrajectoryTracker, ShortPlansCountHalfSeconds) {
  // 19 rows of 4 m/s that stop after 1 s: places 2, 4, 4 m; desired 4 m in 1.5 s = 2.667 m/s, brake
  // above 2.933 m/s. By whole seconds it would be 4 m/s.
  Eigen::MatrixX2d places = ahead(4.0, 19);
  places.bottomRows(9).col(0).setConstant(4.0);
  EXPECT_EQ(TrajectoryTracker().track(2.93, places).brake, 0.0);
  EXPECT_EQ(TrajectoryTracker().track(2.94, places).brake, 1.0);
  // A plan of 0.2 s is one segment: 0.8 m in 0.2 s. One without rows is a stop.
  EXPECT_EQ(TrajectoryTracker().track(4.3, ahead(4.0, 2)).brake, 0.0);
  EXPECT_EQ(TrajectoryTracker().track(4.5, ahead(4.0, 2)).brake, 1.0);
  EXPECT_EQ(TrajectoryTracker().track(0.0, ahead(4.0, 0)), traffic::ControlAction::failSafe());
}

TEST(TrajectoryTracker, AimsAtThePlaceNearestToTheLookAhead) {
  // At 4 m/s the look-ahead is its minimum, 5 m: of 4, 8 and 12 m the first, 0.4 m to the left of
  // it. atan(0.4 / 4) / (pi / 2) = 0.0634510; x (1.25 + 0.75 / 20 + 0.3) = 0.1007285.
  Eigen::MatrixX2d places = ahead(4.0);
  places(9, 1) = 0.4;
  places(19, 1) = -3.0;
  EXPECT_NEAR(TrajectoryTracker().track(4.0, places).steer, 0.1007285, 1e-7);
  // At 10 m/s it is 7.5 m, but of 10, 20 and 30 m still the first.
  places = ahead(10.0);
  places(9, 1) = -1.0;
  EXPECT_NEAR(TrajectoryTracker().track(10.0, places).steer, -0.1007285, 1e-7);
  // At 2.2 m/s, 5 m: the second of 2.2, 4.4 and 6.6 m.
  places = ahead(2.2);
  places(19, 1) = 0.44;
  EXPECT_NEAR(TrajectoryTracker().track(2.2, places).steer, 0.1007285, 1e-7);
}

TEST(TrajectoryTracker, DoesNotSteerWhileItBrakesOrStands) {
  Eigen::MatrixX2d places = ahead(4.0);
  places.col(1).setConstant(2.0);
  EXPECT_GT(TrajectoryTracker().track(4.0, places).steer, 0.0);
  EXPECT_EQ(TrajectoryTracker().track(8.0, places).steer, 0.0);
  EXPECT_EQ(TrajectoryTracker().track(0.009, places).steer, 0.0);
}

TEST(TrajectoryTracker, LookAheadLimitsOutOfOrderAreAnError) {
  TrajectoryTrackerOptions options;
  options.look_ahead_minimum = 9.0;
  EXPECT_THROW(TrajectoryTracker{options}, core::InputError);
}

TEST(TrajectoryTrackerOptions, ReadBackFromTheirOwnText) {
  TrajectoryTrackerOptions options;
  options.pids.turn.kp = 0.75;
  options.pids.window = 40;
  TrajectoryTrackerOptions read;
  core::loadOptions({"text", core::dumpOptions(options, true)}, read);
  EXPECT_EQ(read.pids.turn.kp, 0.75);
  EXPECT_EQ(core::dumpOptions(read), core::dumpOptions(options));
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
  TrajectoryTracker tracker_;
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
}  // namespace cdiff::planners
