// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// A car of SUMO on the minor road must let our vehicle on the major road pass, whatever our vehicle
// does within its lane.
#include <gtest/gtest.h>

#include "simulation/crossing_world.h"

namespace cdiff {
namespace {

using simulation::DrivenVehicle;
using test::CrossingWorld;
using test::kStep;

constexpr double kSpeed = 8.0;          // of our vehicle [m/s]
constexpr double kLaneY = -1.6;         // center of the eastward lane [m]
const traffic::VehicleDimensions kCar;  // 4.5 x 1.8 m

/// What happened at the crossing (times in s; -1: never).
struct Encounter {
  double ours_through =
      -1.0;  // our rear bumper beyond the northward lane: center.x - 2.25 > 1.6 + 0.9
  double other_enters =
      -1.0;  // the other's front bumper in the eastward lane: center.y + 2.25 > -3.2
  double smallest_distance = 1e9;
};

struct Path {
  double start_x = -100.0;
  double y = kLaneY;
  bool excursion = false;  // 8 m to the side between x = -100 and -60, back on the lane at x = -45
};

double lateral(const Path& path, double x) {
  if (!path.excursion) return path.y;
  if (x < -110.0 || x > -45.0) return path.y;
  if (x < -95.0) return path.y - 8.0 * (x + 110.0) / 15.0;
  if (x > -60.0) return path.y - 8.0 * (-45.0 - x) / 15.0;
  return path.y - 8.0;
}

void record(Encounter& encounter, const CrossingWorld& world, const DrivenVehicle& ours,
            double time) {
  if (encounter.ours_through < 0.0 && ours.state.position.x() - 2.25 > 2.5)
    encounter.ours_through = time;
  const simulation::SimulatedVehicle* other = world.find("other");
  if (other == nullptr) return;
  if (encounter.other_enters < 0.0 && other->state.position.y() + 2.25 > -3.2)
    encounter.other_enters = time;
  const geometry::OrientedBox first{ours.state.position, 0.0, kCar.length, kCar.width};
  const geometry::OrientedBox second{other->state.position, other->state.heading, kCar.length,
                                     kCar.width};
  encounter.smallest_distance =
      std::min(encounter.smallest_distance, geometry::distance(first, second));
}

/// Our vehicle drives from path.start_x to x = 60; the other departs so that both would reach the
/// crossing together.
Encounter drive(CrossingWorld& world, const Path& path, bool with_ours = true) {
  Encounter encounter;
  double x = path.start_x;
  if (with_ours) world.simulator().addDriven("ours", kCar, world.ours(x, lateral(path, x), kSpeed));
  const double other_start = 200.0 - 55.0;
  bool other_added = false;
  for (double time = 0.0; x < 60.0; time += kStep) {
    x += kSpeed * kStep;
    // 45 m of ours at 8 m/s take 5.6 s; the other's 55 m at 10 to 13.9 m/s take about 4.5 s.
    if (!other_added && x > -45.0) {
      EXPECT_TRUE(
          world.simulator().addBackground("other", {"south", "north"}, other_start, 0, 10.0, kCar));
      other_added = true;
    }
    const DrivenVehicle ours = world.ours(x, lateral(path, x), kSpeed);
    world.simulator().step(with_ours ? std::vector<DrivenVehicle>{ours}
                                     : std::vector<DrivenVehicle>{});
    record(encounter, world, ours, time);
  }
  return encounter;
}

TEST(Yielding, OtherWouldCrossFirstWithoutOurs) {
  CrossingWorld world;
  const Encounter encounter = drive(world, {}, false);
  ASSERT_GT(encounter.other_enters, 0.0);
  EXPECT_LT(encounter.other_enters, encounter.ours_through);
}

void expectYielded(const Encounter& encounter) {
  ASSERT_GT(encounter.ours_through, 0.0);
  if (encounter.other_enters >= 0.0) {
    EXPECT_GT(encounter.other_enters, encounter.ours_through);
  }
  EXPECT_GT(encounter.smallest_distance, 1.0);
}

TEST(Yielding, InTheMiddleOfTheLane) {
  CrossingWorld world;
  expectYielded(drive(world, {}));
}

TEST(Yielding, BesideTheMiddleOfTheLane) {
  for (double offset : {0.8, -0.8}) {
    CrossingWorld world;
    Path path;
    path.y = kLaneY + offset;
    expectYielded(drive(world, path));
  }
}

TEST(Yielding, UnderABridge) {
  CrossingWorld world(true);
  expectYielded(drive(world, {}));
}

TEST(Yielding, UnderABridgeBesideTheMiddleOfTheLane) {
  CrossingWorld world(true);
  Path path;
  path.y = kLaneY + 0.8;
  expectYielded(drive(world, path));
}

TEST(Yielding, AfterLeavingTheRoadAndComingBack) {
  CrossingWorld world(true);
  Path path;
  path.start_x = -150.0;
  path.y = kLaneY + 0.8;
  path.excursion = true;
  expectYielded(drive(world, path));
}

TEST(Yielding, StartingOffTheRoad) {
  CrossingWorld world;
  Path path;
  path.start_x = -100.0;
  path.excursion = true;
  expectYielded(drive(world, path));
}

}  // namespace
}  // namespace cdiff
