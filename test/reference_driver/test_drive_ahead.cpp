// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "reference_driver/careful_driver.h"
#include "reference_driver/course.h"
#include "reference_driver/drive_ahead.h"

namespace cdiff::reference_driver {
namespace {

using testing::kCar;
using testing::ownAt;

const geometry::Polyline kStraight({{0.0, 0.0, 0.0}, {500.0, 0.0, 0.0}});

OwnMotion startAt(double arc_length, double speed) {
  OwnMotion own = ownAt(speed);
  own.arc_length = arc_length;
  return own;
}

/// Keeps its velocity.
ForeseenVehicle moving(const Eigen::Vector2d& place, double heading, double speed) {
  ForeseenVehicle vehicle{7, kCar, {}};
  for (int i = 0; i < 60; ++i) {
    traffic::VehicleState state;
    state.position = place + 0.1 * i * speed * geometry::direction(heading);
    state.heading = heading;
    state.speed = speed;
    vehicle.states.push_back(state);
  }
  return vehicle;
}

// Bumpers 20.2 m apart at 6 m/s: an unresponsive driver comes within 0.3 m after 3.32 s; the
// careful one, who sees a TTC below 2.5 s after 0.9 s and brakes after 1.15 s, so at 2.1 s,
// needs 11.26 m of the 14.8 m that were left, and stops.
TEST(DriveAhead, TellsWhoStrikesAStandingCar) {
  const DrivenPath path(kStraight, 100.0, 80.0);
  const std::vector<ForeseenVehicle> standing{moving({124.7, 0.0}, 0.0, 0.0)};
  UnresponsiveDriver unresponsive;
  const DriveOutcome struck =
      driveAhead(unresponsive, startAt(100.0, 6.0), path, standing, {6.0, 0.3, 8.0});
  ASSERT_TRUE(struck.contact_time.has_value());
  EXPECT_NEAR(*struck.contact_time, 3.4, 1e-9);
  EXPECT_FALSE(struck.brake_time.has_value());
  EXPECT_EQ(struck.struck, 0U);
  CarefulDriver careful;
  const DriveOutcome answered =
      driveAhead(careful, startAt(100.0, 6.0), path, standing, {6.0, 0.0, 8.0});
  EXPECT_FALSE(answered.contact_time.has_value());
  ASSERT_TRUE(answered.brake_time.has_value());
  EXPECT_NEAR(*answered.brake_time, 0.9 + 1.2, 1e-9);
  EXPECT_EQ(answered.at_contact.speed, 0.0);
}

TEST(DriveAhead, SeesVehiclesInTheCoordinatesOfACurvedPath) {
  std::vector<Eigen::Vector3d> points;  // a left turn of 20 m radius
  for (int i = 0; i <= 90; ++i) {
    const double angle = i * 3.14159265 / 180.0;
    points.push_back({20.0 * std::sin(angle), 20.0 * (1.0 - std::cos(angle)), 0.0});
  }
  const geometry::Polyline turn(points);
  const DrivenPath path(turn, 0.0, 60.0);
  traffic::VehicleState on_path;
  on_path.position = turn.positionAt(20.0) + Eigen::Vector2d(0.0, 0.0);
  on_path.heading = turn.headingAt(20.0);
  on_path.speed = 5.0;
  std::optional<std::size_t> hint;
  const auto seen = path.see(on_path, kCar, hint);
  ASSERT_TRUE(seen.has_value());
  EXPECT_NEAR(seen->arc_length, 20.0, 0.1);
  EXPECT_NEAR(seen->offset, 0.0, 0.05);
  EXPECT_NEAR(seen->along_speed, 5.0, 0.02);
  traffic::VehicleState beyond = on_path;
  beyond.position = {-200.0, 0.0};
  hint.reset();
  EXPECT_FALSE(path.see(beyond, kCar, hint).has_value());
}

// 1 m/s^2 held for 1 s from 8 m/s, up to 8.5.
TEST(DriveAhead, HoldsAnAccelerationForASecondUpToTheTopSpeed) {
  const DrivenPath path(kStraight, 100.0, 80.0);
  UnresponsiveDriver driver;
  OwnMotion start = startAt(100.0, 8.0);
  start.acceleration = 1.0;
  EXPECT_NEAR(driveAhead(driver, start, path, {}, {3.0, 0.3, 20.0}).at_contact.speed, 9.0, 1e-9);
  EXPECT_NEAR(driveAhead(driver, start, path, {}, {3.0, 0.3, 8.5}).at_contact.speed, 8.5, 1e-9);
}

}  // namespace
}  // namespace cdiff::reference_driver
