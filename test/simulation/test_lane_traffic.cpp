// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>

#include "e2e_cdiff/core/exceptions.h"
#include "simulation/crossing_world.h"
#include "simulation/lane_traffic.h"

namespace cdiff::simulation {
namespace {

constexpr double kStep = test::kStep;
constexpr double kEastward = -1.6;  // y of the eastward lane [m]

class LaneTrafficTest : public ::testing::Test {
 protected:
  explicit LaneTrafficTest(int lanes = 1)
      : made_(test::makeCrossing(folder_, false, lanes)),
        graph_(made_.network),
        route_(test::routeOnFirstLanes(graph_, "west", "east")),
        traffic_(graph_, kStep) {}

  /// A car of 4.5 x 1.8 m; its front bumper `position` meters along the first edge.
  bool add(const std::string& id, const std::vector<std::string>& edges, double position,
           double speed, int lane = 0) {
    return traffic_.addBackground(id, edges, position, lane, speed, {});
  }
  DrivenVehicle ours(const std::string& id, double x, double y, double speed,
                     double heading = 0.0) const {
    DrivenVehicle vehicle;
    vehicle.id = id;
    vehicle.state.position = {x, y};
    vehicle.state.speed = speed;
    vehicle.state.heading = heading;
    vehicle.route = &route_;
    return vehicle;
  }
  void run(double seconds, const std::vector<DrivenVehicle>& driven = {}) {
    for (int i = 0; i < std::lround(seconds / kStep); ++i) traffic_.step(driven);
  }
  const SimulatedVehicle* find(const std::string& id) const {
    return findVehicle(traffic_.vehicles(), id);
  }
  static geometry::OrientedBox boxOf(const SimulatedVehicle& vehicle) {
    return {vehicle.state.position, vehicle.state.heading, vehicle.dimensions.length,
            vehicle.dimensions.width};
  }
  /// Whether a vehicle is this far along y, or along x; it may leave later.
  bool northOf(const std::string& id, double y) const {
    return find(id) != nullptr && find(id)->state.position.y() > y;
  }
  bool eastOf(const std::string& id, double x) const {
    return find(id) != nullptr && find(id)->state.position.x() > x;
  }
  bool anyOverlap() const {
    const auto& all = traffic_.vehicles();
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (std::size_t j = i + 1; j < all.size(); ++j)
        if (geometry::overlap(boxOf(all[i]), boxOf(all[j]))) return true;
    }
    return false;
  }

  test::TemporaryFolder folder_;
  test::SumoNetwork made_;
  map::LaneGraph graph_;
  map::Route route_;
  LaneTraffic traffic_;
};

// The front starts 50 m along the edge that begins at x = -200: the center at -152.25. The limit is
// 13.89 m/s and drivers keep within 15 % of it; IDM comes within 3 % of its speed in 20 s.
TEST_F(LaneTrafficTest, FollowsItsLaneAtItsSpeed) {
  ASSERT_TRUE(add("a", {"west", "east", "far"}, 50.0, 10.0));
  run(kStep);
  EXPECT_NEAR(find("a")->state.position.x(), -152.25 + 10.0 * kStep, 0.05);
  EXPECT_EQ(find("a")->lane_id, "west_0");
  run(20.0);
  EXPECT_NEAR(find("a")->state.position.y(), kEastward, 0.05);
  EXPECT_NEAR(find("a")->state.heading, 0.0, 1e-6);
  EXPECT_GT(find("a")->state.speed, 0.97 * 0.85 * 13.89);
  EXPECT_LE(find("a")->state.speed, 1.15 * 13.89);
}

// The other's rear is at -100 - 2.25; IDM stops s0 = 2.5 m behind it, or a little more.
TEST_F(LaneTrafficTest, StopsBehindWhoStands) {
  traffic_.addDriven("ours", {}, ours("ours", -100.0, kEastward, 0.0));
  ASSERT_TRUE(add("a", {"west", "east"}, 30.0, 13.0));
  run(30.0, {ours("ours", -100.0, kEastward, 0.0)});
  const double gap = -102.25 - (find("a")->state.position.x() + 2.25);
  EXPECT_LT(find("a")->state.speed, 0.2);
  EXPECT_GT(gap, 1.5);
  EXPECT_LT(gap, 5.0);
}

// Ours crosses from the west at 8 m/s; a car from the south would be at the crossing with it.
TEST_F(LaneTrafficTest, YieldsToOursAndThenGoes) {
  DrivenVehicle vehicle = ours("ours", -60.0, kEastward, 8.0);
  traffic_.addDriven("ours", {}, vehicle);
  ASSERT_TRUE(add("a", {"south", "north"}, 140.0, 8.0));
  bool crossed = false;
  for (int i = 0; i < 400; ++i) {
    vehicle.state.position.x() += 8.0 * kStep;
    traffic_.step({vehicle});
    ASSERT_FALSE(anyOverlap()) << "step " << i;
    crossed = crossed || northOf("a", 20.0);
  }
  EXPECT_TRUE(crossed);
}

TEST_F(LaneTrafficTest, OneOfTwoThatCrossGoesFirst) {
  ASSERT_TRUE(add("a", {"south", "north"}, 140.0, 8.0));
  ASSERT_TRUE(add("b", {"west", "east"}, 140.0, 8.0));
  bool a_crossed = false;
  bool b_crossed = false;
  for (int i = 0; i < 400; ++i) {
    traffic_.step({});
    ASSERT_FALSE(anyOverlap()) << "step " << i;
    a_crossed = a_crossed || northOf("a", 20.0);
    b_crossed = b_crossed || eastOf("b", 20.0);
  }
  EXPECT_TRUE(a_crossed);
  EXPECT_TRUE(b_crossed);
}

TEST_F(LaneTrafficTest, DrivenVehiclesAreWhereTheyAreMoved) {
  ASSERT_TRUE(add("a", {"west", "east"}, 100.0, 8.0));
  run(1.0);
  traffic_.takeOver("a");
  run(1.0, {ours("a", -50.0, 3.0, 2.0, 0.3)});
  EXPECT_EQ(find("a")->state.position, Eigen::Vector2d(-50.0, 3.0));
  EXPECT_EQ(find("a")->state.speed, 2.0);
  EXPECT_EQ(find("a")->state.heading, 0.3);
}

// Given back 1 m to the left of its lane it goes on from there, and is on the lane some seconds
// later.
TEST_F(LaneTrafficTest, ReleasedVehiclesSettleOnTheirRoute) {
  ASSERT_TRUE(add("a", {"west", "east"}, 100.0, 8.0));
  run(1.0);
  traffic_.takeOver("a");
  const DrivenVehicle beside = ours("a", -50.0, kEastward + 1.0, 8.0, 0.1);
  run(kStep, {beside});
  EXPECT_TRUE(traffic_.release(beside));
  run(kStep);
  EXPECT_NEAR(find("a")->state.position.x(), -50.0 + 8.0 * kStep, 0.05);
  EXPECT_NEAR(find("a")->state.position.y(), kEastward + 1.0, 0.1);
  run(4.0);
  EXPECT_NEAR(find("a")->state.position.y(), kEastward, 0.02);
}

TEST_F(LaneTrafficTest, VehiclesFarOffTheirRouteAreNotReleased) {
  for (const DrivenVehicle& away :
       {ours("a", -50.0, kEastward + 2.5, 8.0), ours("a", -50.0, kEastward, 8.0, 0.8)}) {
    ASSERT_TRUE(add("a", {"west", "east"}, 100.0, 8.0));
    run(kStep);
    traffic_.takeOver("a");
    run(kStep, {away});
    EXPECT_FALSE(traffic_.release(away));
    run(kStep);
    EXPECT_EQ(find("a"), nullptr);
  }
}

// The world removes whoever it finds in the last report: also one that was not released, or that
// was in contact, in the same tick.
TEST_F(LaneTrafficTest, WhoWentSinceTheLastStepMayBeRemovedAgain) {
  ASSERT_TRUE(add("a", {"west", "east"}, 100.0, 8.0));
  run(kStep);
  traffic_.takeOver("a");
  const DrivenVehicle away = ours("a", -50.0, kEastward + 2.5, 8.0);
  run(kStep, {away});
  EXPECT_FALSE(traffic_.release(away));
  ASSERT_NE(find("a"), nullptr);
  EXPECT_NO_THROW(traffic_.remove("a"));
  run(kStep);
  EXPECT_THROW(traffic_.remove("a"), core::SimulatorError);
}

TEST_F(LaneTrafficTest, VehiclesLeaveAtTheEndOfTheirRoute) {
  ASSERT_TRUE(add("a", {"west"}, 150.0, 12.0));
  run(1.0);
  EXPECT_NE(find("a"), nullptr);
  run(10.0);
  EXPECT_EQ(find("a"), nullptr);
}

TEST_F(LaneTrafficTest, RefusesWhatIsNotThere) {
  EXPECT_FALSE(add("a", {"nowhere"}, 20.0, 8.0));
  EXPECT_FALSE(add("a", {"west"}, 20.0, 8.0, 4));
  EXPECT_FALSE(add("a", {"west"}, 2.0, 8.0));  // its rear would lie before the edge
  EXPECT_THROW(traffic_.takeOver("a"), core::SimulatorError);
  EXPECT_THROW(traffic_.remove("a"), core::SimulatorError);
  EXPECT_THROW(run(kStep, {ours("a", 0.0, 0.0, 1.0)}), core::SimulatorError);
}

TEST_F(LaneTrafficTest, SameCallsSameTraffic) {
  LaneTraffic other(graph_, kStep);
  for (LaneTraffic* traffic : {&traffic_, &other}) {
    traffic->addBackground("a", {"south", "north"}, 140.0, 0, 8.0, {});
    traffic->addBackground("b", {"west", "east"}, 140.0, 0, 8.0, {});
    for (int i = 0; i < 200; ++i) traffic->step({});
  }
  ASSERT_EQ(traffic_.vehicles().size(), other.vehicles().size());
  for (std::size_t i = 0; i < other.vehicles().size(); ++i) {
    EXPECT_EQ(traffic_.vehicles()[i].id, other.vehicles()[i].id);
    EXPECT_EQ(traffic_.vehicles()[i].state.position, other.vehicles()[i].state.position);
  }
}

class LaneTrafficOnTwoLanes : public LaneTrafficTest {
 protected:
  LaneTrafficOnTwoLanes() : LaneTrafficTest(2) {}
};

// Left turns leave from the left lane: who starts on the right one changes on its way.
TEST_F(LaneTrafficOnTwoLanes, ChangesLanesWhereItsRouteNeedsIt) {
  ASSERT_TRUE(add("a", {"west", "north"}, 60.0, 8.0));
  run(kStep);
  EXPECT_EQ(find("a")->lane_id, "west_0");
  bool left = false;
  for (int i = 0; i < 600 && find("a") != nullptr && find("a")->lane_id != "north_0"; ++i) {
    traffic_.step({});
    if (find("a") != nullptr) left = left || find("a")->lane_id == "west_1";
  }
  EXPECT_TRUE(left);
  ASSERT_NE(find("a"), nullptr);
  EXPECT_EQ(find("a")->lane_id, "north_0");
}

}  // namespace
}  // namespace cdiff::simulation
