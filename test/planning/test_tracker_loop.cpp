// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <functional>

#include "e2e_cdiff/dynamics/bicycle_model.h"
#include "planning/plan_tracker.h"

namespace cdiff::planning {
namespace {

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
  PlanTracker tracker_{PlanTrackerOptions::published()};
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
