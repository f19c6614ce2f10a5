// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// A vehicle changes hands between SUMO and us without a jump, in both directions.
#include <gtest/gtest.h>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "simulation/crossing_world.h"

namespace cdiff {
namespace {

using simulation::DrivenVehicle;
using simulation::SimulatedVehicle;
using test::CrossingWorld;
using test::kStep;

const traffic::VehicleDimensions kCar;  // 4.5 x 1.8 m

/// A car of SUMO on edge `west` (200 m, lane center y = -1.6 m), driven for two seconds from x =
/// -150 m.
void addOther(CrossingWorld& world, double speed, int lane = 0) {
  ASSERT_TRUE(
      world.simulator().addBackground("other", {"west", "east", "far"}, 50.0, lane, speed, kCar));
  for (int i = 0; i < 40; ++i) world.simulator().step({});
  ASSERT_NE(world.find("other"), nullptr);
}

TEST(SimulatedVehicleTest, ASnapshotHoldsAllOfIt) {
  SimulatedVehicle simulated;
  simulated.id = "other";
  simulated.state.position = {3.0, -1.6};
  simulated.state.speed = 7.0;
  simulated.dimensions.length = 12.0;
  simulated.dimensions.width = 2.5;
  simulated.acceleration = -1.5;
  simulated.lane_id = "west_0";
  const traffic::Vehicle vehicle = simulation::asBackground(simulated);
  EXPECT_EQ(vehicle.id, "other");
  EXPECT_EQ(vehicle.state.position, simulated.state.position);
  EXPECT_EQ(vehicle.state.speed, 7.0);
  EXPECT_EQ(vehicle.dimensions.length, 12.0);
  EXPECT_EQ(vehicle.dimensions.width, 2.5);
  EXPECT_EQ(vehicle.acceleration, -1.5);
  EXPECT_EQ(vehicle.lane_id, "west_0");
}

/// Advances a state straight ahead, sideways by `drift` meters.
DrivenVehicle ahead(const CrossingWorld& world, const traffic::VehicleState& state,
                    double drift = 0.0) {
  DrivenVehicle vehicle;
  vehicle.id = "other";
  vehicle.state = state;
  vehicle.state.position +=
      state.velocity() * kStep + drift * geometry::leftNormal(geometry::direction(state.heading));
  vehicle.route = &world.route();
  return vehicle;
}

/// Largest changes of one step over the time after a release.
struct Changes {
  double sideways = 0.0;
  double lengthwise = 0.0;  // beyond speed x step
  double heading = 0.0;
  double speed = 0.0;
  std::string lane;
};

Changes observe(CrossingWorld& world, traffic::VehicleState before, int steps) {
  Changes changes;
  for (int i = 0; i < steps; ++i) {
    world.simulator().step({});
    const SimulatedVehicle* now = world.find("other");
    if (now == nullptr) {
      ADD_FAILURE() << "the vehicle is gone at step " << i;
      return changes;
    }
    if (i == 0) changes.lane = now->lane_id;
    const Eigen::Vector2d moved = before.pose().toBody(now->state.position);
    changes.sideways = std::max(changes.sideways, std::abs(moved.y()));
    changes.lengthwise = std::max(changes.lengthwise, std::abs(moved.x() - before.speed * kStep));
    changes.heading = std::max(changes.heading,
                               std::abs(core::angleDifference(now->state.heading, before.heading)));
    changes.speed = std::max(changes.speed, std::abs(now->state.speed - before.speed));
    before = now->state;
  }
  return changes;
}

void expectSmooth(const Changes& changes) {
  EXPECT_LT(changes.sideways, 0.1);  // 2 m/s; a jump into the lane would be 0.7 m
  EXPECT_LT(changes.lengthwise, 0.3);
  EXPECT_LT(changes.heading, core::degreesToRadians(5.0));
  EXPECT_LT(changes.speed, 0.5);  // 10 m/s^2
}

TEST(TakeOver, TheVehicleIsWhereWePutIt) {
  CrossingWorld world;
  addOther(world, 10.0);
  const traffic::VehicleState before = world.find("other")->state;
  EXPECT_NEAR(before.position.y(), -1.6, 1e-6);
  EXPECT_NEAR(before.heading, 0.0, 1e-9);
  world.simulator().takeOver("other");
  DrivenVehicle vehicle = ahead(world, before);
  for (int i = 0; i < 100; ++i) {
    world.simulator().step({vehicle});
    const SimulatedVehicle* echo = world.find("other");
    ASSERT_NE(echo, nullptr);
    EXPECT_NEAR((echo->state.position - vehicle.state.position).norm(), 0.0, 1e-6);
    vehicle = ahead(world, vehicle.state, 0.004);
  }
}

TEST(TakeOver, OfAnUnknownVehicleIsAnError) {
  CrossingWorld world;
  EXPECT_THROW(world.simulator().takeOver("nobody"), core::SimulatorError);
  EXPECT_THROW(world.simulator().step({ahead(world, {})}), core::SimulatorError);
}

TEST(Driven, StaysPastTheEndOfTheNetwork) {
  CrossingWorld world;
  double x = 380.0;  // the network ends at x = 400 m
  world.simulator().addDriven("ours", kCar, world.ours(x, -1.6, 8.0));
  int missing = 0;
  for (int i = 0; i < 200; ++i) {
    x += 8.0 * kStep;
    world.simulator().step({world.ours(x, -1.6, 8.0)});
    const SimulatedVehicle* ours = world.find("ours");
    if (ours == nullptr) {
      ++missing;
    } else {
      EXPECT_NEAR(ours->state.position.x(), x, 1e-6);
    }
  }
  EXPECT_LE(missing, 2);
}

TEST(Driven, IsSeenByTrafficBehind) {
  CrossingWorld world;
  world.simulator().addDriven("ours", kCar, world.ours(-100.0, -1.6, 0.0));
  world.simulator().step({world.ours(-100.0, -1.6, 0.0)});
  ASSERT_TRUE(world.simulator().addBackground("other", {"west", "east"}, 20.0, 0, 10.0, kCar));
  for (int i = 0; i < 400; ++i) world.simulator().step({world.ours(-100.0, -1.6, 0.0)});
  const double gap = -100.0 - world.find("other")->state.position.x() - kCar.length;
  EXPECT_GT(gap, 1.0);  // SUMO's minimum gap is 2.5 m
  EXPECT_LT(gap, 10.0);
  world.simulator().remove("ours");
  for (int i = 0; i < 100; ++i) world.simulator().step({});
  EXPECT_EQ(world.find("ours"), nullptr);
  EXPECT_GT(world.find("other")->state.speed, 3.0);
}

class Release : public testing::TestWithParam<std::tuple<double, double>> {};

TEST_P(Release, HasNoJump) {
  const auto [speed, offset] = GetParam();
  CrossingWorld world;
  addOther(world, std::max(speed, 1.0));
  world.simulator().takeOver("other");
  traffic::VehicleState state = world.find("other")->state;
  state.speed = speed;
  DrivenVehicle vehicle = ahead(world, state, offset / 40.0);
  for (int i = 0; i < 40; ++i) {  // drifts to `offset` beside the lane's center in 2 s
    world.simulator().step({vehicle});
    if (i < 39) vehicle = ahead(world, vehicle.state, offset / 40.0);
  }
  ASSERT_NEAR(vehicle.state.position.y(), -1.6 + offset, 1e-6);
  ASSERT_TRUE(world.simulator().release(vehicle));
  const Changes first = observe(world, vehicle.state, 1);
  expectSmooth(first);
  EXPECT_EQ(first.lane, "west_0");
  expectSmooth(observe(world, world.find("other")->state, 200));
  EXPECT_GT(world.find("other")->state.speed, 5.0);
  EXPECT_NEAR(world.find("other")->state.position.y(), -1.6,
              0.05);  // back in the middle of the lane
}

INSTANTIATE_TEST_SUITE_P(SpeedsAndOffsets, Release,
                         testing::Combine(testing::Values(0.0, 0.5, 3.0, 8.0, 13.0),
                                          testing::Values(0.0, 0.7, -0.7, 1.2)));

TEST(ReleaseRefused, OffTheRoad) {
  CrossingWorld world;
  addOther(world, 10.0);
  world.simulator().takeOver("other");
  traffic::VehicleState state = world.find("other")->state;
  state.position.y() -= 8.0;
  DrivenVehicle vehicle = ahead(world, state);
  world.simulator().step({vehicle});
  EXPECT_FALSE(world.simulator().release(vehicle));
  world.simulator().step({});
  EXPECT_EQ(world.find("other"), nullptr);
}

TEST(ReleaseAskew, TurnsIntoTheLane) {
  CrossingWorld world;
  addOther(world, 8.0);
  world.simulator().takeOver("other");
  traffic::VehicleState state = world.find("other")->state;
  state.heading = core::degreesToRadians(20.0);
  const DrivenVehicle vehicle = ahead(world, state);
  world.simulator().step({vehicle});
  ASSERT_TRUE(world.simulator().release(vehicle));
  expectSmooth(observe(world, vehicle.state, 200));
  EXPECT_NEAR(world.find("other")->state.heading, 0.0, 0.01);
}

// On the lane, but more than 30 degrees off its direction: SUMO would turn it at once.
TEST(ReleaseAskew, AcrossTheLaneIsRefused) {
  for (const auto& [degrees, released] :
       {std::pair{25.0, true}, {35.0, false}, {45.0, false}, {-45.0, false}}) {
    CrossingWorld world;
    addOther(world, 8.0);
    world.simulator().takeOver("other");
    traffic::VehicleState state = world.find("other")->state;
    state.heading = core::degreesToRadians(degrees);
    const DrivenVehicle vehicle = ahead(world, state);
    world.simulator().step({vehicle});
    EXPECT_EQ(world.find("other")->lane_id, "west_0");
    EXPECT_EQ(world.simulator().release(vehicle), released) << degrees;
  }
}

TEST(ReleaseAskew, AgainstTheLaneIsRefused) {
  CrossingWorld world;
  addOther(world, 8.0);
  world.simulator().takeOver("other");
  traffic::VehicleState state = world.find("other")->state;
  state.heading = core::kPi;
  const DrivenVehicle vehicle = ahead(world, state);
  world.simulator().step({vehicle});
  EXPECT_FALSE(world.simulator().release(vehicle));
}

TEST(ReleaseInABend, HasNoJump) {
  CrossingWorld world;
  const map::Route turn = test::routeOnFirstLanes(world.graph(), "west", "north");
  addOther(world, 8.0);
  world.simulator().takeOver("other");
  DrivenVehicle vehicle = ahead(world, world.find("other")->state);
  vehicle.route = &turn;
  double s = turn.path().project(vehicle.state.position).arc_length;
  while (vehicle.state.heading < core::degreesToRadians(45.0)) {  // half of the left turn
    s += 6.0 * kStep;
    const Eigen::Vector2d front = turn.path().positionAt(s + 2.25);
    const Eigen::Vector2d rear = turn.path().positionAt(s - 2.25);
    vehicle.state.position = 0.5 * (front + rear);
    vehicle.state.heading = std::atan2(front.y() - rear.y(), front.x() - rear.x());
    vehicle.state.speed = 6.0;
    world.simulator().step({vehicle});
  }
  ASSERT_EQ(world.find("other")->lane_id.front(), ':');
  ASSERT_TRUE(world.simulator().release(vehicle));
  expectSmooth(observe(world, vehicle.state, 100));
  EXPECT_EQ(world.find("other")->lane_id, "north_0");
}

TEST(ReleaseInAJunction, GoesOnAlongItsRoute) {
  CrossingWorld world;
  addOther(world, 10.0);
  world.simulator().takeOver("other");
  DrivenVehicle vehicle = ahead(world, world.find("other")->state);
  while (vehicle.state.position.x() < 0.0) {
    world.simulator().step({vehicle});
    vehicle = ahead(world, vehicle.state);
  }
  world.simulator().step({vehicle});
  ASSERT_EQ(world.find("other")->lane_id.front(), ':');
  ASSERT_TRUE(world.simulator().release(vehicle));
  expectSmooth(observe(world, vehicle.state, 100));
}

}  // namespace
}  // namespace cdiff
