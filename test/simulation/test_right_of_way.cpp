// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "simulation/traffic_observer.h"
#include "support/network_text.h"

namespace cdiff::simulation {
namespace {

/// A junction "c" at the origin: roads from the west and the south lead to the east.
map::RoadNetwork makeNetwork() {
  return test::NetworkText()
      .edge("west", {"-100,0 -5,0"}, "w", "c")
      .edge("south", {"0,-100 0,-5"}, "s", "c")
      .edge("east", {"5,0 100,0"}, "c", "e")
      .edge(":c_0", {"-5,0 5,0"})
      .edge(":c_1", {"0,-5 5,0"})
      .junction("c", "-5,-5 -5,5 5,5 5,-5")
      .connection("west_0", "east_0", ":c_0_0")
      .connection("south_0", "east_0", ":c_1_0", 'r')
      .network();
}

class RightOfWayTest : public testing::Test {
 protected:
  /// A vehicle of 4.5 m whose front bumper is `gap` meters before the stop line.
  static SimulatedVehicle on(const std::string& id, const std::string& road, double gap,
                             double speed) {
    SimulatedVehicle vehicle;
    vehicle.id = id;
    const double center = -5.0 - gap - 2.25;
    vehicle.state.position =
        road == "west" ? Eigen::Vector2d(center, 0.0) : Eigen::Vector2d(0.0, center);
    vehicle.state.speed = speed;
    vehicle.lane_id = road + "_0";
    return vehicle;
  }
  static SimulatedVehicle inside(const std::string& id, double speed) {
    SimulatedVehicle vehicle;
    vehicle.id = id;
    vehicle.state.speed = speed;
    vehicle.lane_id = ":c_0_0";
    return vehicle;
  }
  /// Runs for some seconds; answers the last vehicle that was given way, "" when none.
  std::string firstToGo(const std::vector<SimulatedVehicle>& vehicles, double seconds,
                        const std::string& ours = "") {
    std::string granted;
    for (double time = 0.0; time < seconds - 1e-9; time += 0.05) {
      for (const RightOfWayChange& change :
           row_.update(
                   vehicles, [&](const std::string& id) { return id == ours; }, 0.05)
               .vehicles) {
        granted = change.may_go ? change.vehicle_id : "";
      }
    }
    return granted;
  }

  map::RoadNetwork network_ = makeNetwork();
  RightOfWay row_{network_, {}};
};

// Patience is 1 s: 20 updates of 0.05 s.
TEST_F(RightOfWayTest, OneOfTwoThatWaitGoesAfterASecond) {
  const std::vector<SimulatedVehicle> waiting = {on("a", "west", 1.0, 0.0),
                                                 on("b", "south", 1.0, 0.0)};
  EXPECT_EQ(firstToGo(waiting, 0.9), "");
  EXPECT_EQ(firstToGo(waiting, 0.2), "a") << "ties go to the first by id";
}

TEST_F(RightOfWayTest, TheLongestWaitGoesFirst) {
  firstToGo({on("b", "south", 1.0, 0.0)}, 0.5);
  EXPECT_EQ(firstToGo({on("a", "west", 1.0, 0.0), on("b", "south", 1.0, 0.0)}, 0.6), "b");
}

TEST_F(RightOfWayTest, NobodyGoesWhileTheJunctionMoves) {
  EXPECT_EQ(firstToGo({on("a", "west", 1.0, 0.0), inside("m", 3.0)}, 3.0), "");
  EXPECT_EQ(firstToGo({on("a", "west", 1.0, 0.0), on("m", "south", 15.0, 8.0)}, 3.0), "");
}

TEST_F(RightOfWayTest, InsideGoesBeforeTheStopLines) {
  EXPECT_EQ(firstToGo({on("a", "west", 1.0, 0.0), inside("z", 0.0)}, 1.05), "z");
}

TEST_F(RightOfWayTest, FarFromTheStopLineNobodyWaits) {
  EXPECT_EQ(firstToGo({on("a", "west", 9.0, 0.0)}, 3.0), "");
}

TEST_F(RightOfWayTest, NobodyGoesBeforeOurs) {
  EXPECT_EQ(firstToGo({on("a", "west", 1.0, 0.0), on("ego", "south", 40.0, 8.0)}, 3.0, "ego"), "");
}

TEST_F(RightOfWayTest, AGrantEndsWhenOursArrives) {
  ASSERT_EQ(firstToGo({on("a", "west", 1.0, 0.0)}, 1.05), "a");
  const auto changes = row_.update(
      {on("a", "west", 0.5, 1.0), on("ego", "south", 15.0, 8.0)},
      [](const std::string& id) { return id == "ego"; }, 0.05);
  ASSERT_EQ(changes.vehicles.size(), 1u);
  EXPECT_EQ(changes.vehicles[0].vehicle_id, "a");
  EXPECT_FALSE(changes.vehicles[0].may_go);
}

TEST_F(RightOfWayTest, TheQueueAheadOfOursGoes) {
  EXPECT_EQ(firstToGo({on("a", "west", 1.0, 0.0), on("b", "south", 1.0, 0.0),
                       on("ego", "south", 40.0, 8.0)},
                      1.05, "ego"),
            "b");
}

TEST_F(RightOfWayTest, WhoCannotGoLosesTheTurn) {
  const std::vector<SimulatedVehicle> waiting = {on("a", "west", 1.0, 0.0),
                                                 on("b", "south", 1.0, 0.0)};
  ASSERT_EQ(firstToGo(waiting, 1.05), "a");
  // 1.5 s without moving: the turn ends, and b, who has waited longer by then, is next.
  EXPECT_EQ(firstToGo(waiting, 1.65), "b");
}

}  // namespace
}  // namespace cdiff::simulation
