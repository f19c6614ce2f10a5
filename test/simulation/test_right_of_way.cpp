// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <memory>

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
           row_->update(
                   vehicles, [&](const std::string& id) { return id == ours; }, 0.05)
               .vehicles) {
        granted = change.may_go ? change.vehicle_id : "";
      }
    }
    return granted;
  }

  /// Who is given way ("+a") and from whom it is taken ("-a") within some seconds.
  std::vector<std::string> changesWithin(const std::vector<SimulatedVehicle>& vehicles,
                                         double seconds, const std::string& ours = "") {
    std::vector<std::string> texts;
    for (double time = 0.0; time < seconds - 1e-9; time += 0.05) {
      const auto changes = row_->update(
          vehicles, [&](const std::string& id) { return id == ours; }, 0.05);
      for (const RightOfWayChange& change : changes.vehicles)
        texts.push_back((change.may_go ? "+" : "-") + change.vehicle_id);
    }
    return texts;
  }
  /// Whether "a", who stands at the western stop line, is given way beside another vehicle.
  bool goesBeside(const SimulatedVehicle& other, const std::string& ours = "") {
    row_ = std::make_unique<RightOfWay>(network_, std::vector<traffic::SignalState>{});
    return !changesWithin({on("a", "west", 1.0, 0.0), other}, 1.05, ours).empty();
  }

  map::RoadNetwork network_ = makeNetwork();
  std::unique_ptr<RightOfWay> row_ =
      std::make_unique<RightOfWay>(network_, std::vector<traffic::SignalState>{});
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
  const auto changes = row_->update(
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

// 0.9 s each, and it moved up in between.
TEST_F(RightOfWayTest, WhoMovesUpWaitsAnew) {
  EXPECT_TRUE(changesWithin({on("a", "west", 2.0, 0.0)}, 0.9).empty());
  EXPECT_TRUE(changesWithin({on("a", "west", 1.9, 0.2)}, 0.05).empty());
  EXPECT_TRUE(changesWithin({on("a", "west", 1.0, 0.0)}, 0.9).empty());
  EXPECT_EQ(changesWithin({on("a", "west", 1.0, 0.0)}, 0.15), std::vector<std::string>{"+a"});
}

// At most 8 m before the stop line a vehicle waits; nearer than 20 m and faster than 4 m/s it is
// let through; in the junction 0.5 m/s is moving.
TEST_F(RightOfWayTest, WhoWaitsAndWhoIsLetThrough) {
  EXPECT_EQ(changesWithin({on("w", "south", 7.9, 0.0)}, 1.05), std::vector<std::string>{"+w"});
  EXPECT_TRUE(changesWithin({on("v", "south", 8.1, 0.0)}, 3.0).size() == 1)
      << "only w, who is gone, loses its turn";
  EXPECT_FALSE(goesBeside(on("m", "south", 19.9, 4.1)));
  EXPECT_TRUE(goesBeside(on("m", "south", 20.1, 4.1)));
  EXPECT_TRUE(goesBeside(on("m", "south", 15.0, 3.9)));
  EXPECT_FALSE(goesBeside(inside("m", 0.6)));
  EXPECT_TRUE(goesBeside(inside("m", 0.4)));
}

// Ours comes within 50 m unless it stands; inside the junction others go until it is within 20 m.
TEST_F(RightOfWayTest, OursComesFirstWhereItIsNear) {
  EXPECT_FALSE(goesBeside(on("ego", "south", 49.0, 0.6), "ego"));
  EXPECT_TRUE(goesBeside(on("ego", "south", 51.0, 8.0), "ego"));
  EXPECT_TRUE(goesBeside(on("ego", "south", 40.0, 0.4), "ego"));
  EXPECT_EQ(changesWithin({inside("z", 0.0), on("ego", "south", 20.1, 8.0)}, 1.05, "ego"),
            (std::vector<std::string>{"-a", "+z"}));
  row_ = std::make_unique<RightOfWay>(network_, std::vector<traffic::SignalState>{});
  EXPECT_TRUE(changesWithin({inside("z", 0.0), on("ego", "south", 19.9, 8.0)}, 3.0, "ego").empty());
}

// A turn of a vehicle that moves lasts 5 s, ours on the same edge behind it does not end it.
TEST_F(RightOfWayTest, ATurnEndsAfterFiveSecondsOrWithItsVehicle) {
  ASSERT_EQ(firstToGo({on("a", "west", 1.0, 0.0)}, 1.05), "a");
  const std::vector<SimulatedVehicle> moving = {on("a", "west", 0.5, 1.0),
                                                on("ego", "west", 15.0, 8.0)};
  EXPECT_TRUE(changesWithin(moving, 4.9, "ego").empty());
  EXPECT_EQ(changesWithin(moving, 0.2, "ego"), std::vector<std::string>{"-a"});
  ASSERT_EQ(firstToGo({on("a", "west", 1.0, 0.0)}, 1.05), "a");
  EXPECT_EQ(changesWithin({}, 0.05), std::vector<std::string>{"-a"});
}

// Link 0 of the light is the west's, link 1 the south's. One of ours comes from the south.
TEST(RightOfWayAtALight, AQueueAheadOfOursHasPriorityUntilItIsGone) {
  const map::RoadNetwork network =
      test::NetworkText()
          .edge("west", {"-100,0 -5,0"}, "w", "c")
          .edge("south", {"0,-100 0,-5"}, "s", "c")
          .edge("east", {"5,0 100,0"}, "c", "e")
          .edge(":c_0", {"-5,0 5,0"})
          .edge(":c_1", {"0,-5 5,0"})
          .junction("c", "-5,-5 -5,5 5,5 5,-5", "traffic_light")
          .connection("west_0", "east_0", ":c_0_0", 's', "tl=\"c\" linkIndex=\"0\"")
          .connection("south_0", "east_0", ":c_1_0", 'r', "tl=\"c\" linkIndex=\"1\"")
          .network();
  RightOfWay row(network, {{"c", "gg"}});
  const auto vehicle = [](const std::string& id, double x, double y, const std::string& lane) {
    SimulatedVehicle made;
    made.id = id;
    made.state.position = {x, y};
    made.lane_id = lane;
    return made;
  };
  const SimulatedVehicle queue = vehicle("b", 0.0, -10.0, "south_0");
  const SimulatedVehicle ego = vehicle("ego", 0.0, -20.0, "south_0");
  const SimulatedVehicle cbv = vehicle("cbv", -20.0, 0.0, "west_0");
  const auto shown = [&](const std::vector<SimulatedVehicle>& vehicles) {
    const auto changes = row.update(
        vehicles, [](const std::string& id) { return id != "b"; }, 0.05);
    return changes.signals.empty() ? "" : changes.signals[0].id + " " + changes.signals[0].state;
  };
  EXPECT_EQ(shown({ego}), "");
  EXPECT_EQ(shown({queue, ego}), "c gG");
  EXPECT_EQ(shown({queue, ego}), "") << "no change";
  EXPECT_EQ(shown({queue, ego, cbv}), "c gg") << "ours come from two sides";
  EXPECT_EQ(shown({queue, ego}), "c gG");
  EXPECT_EQ(shown({vehicle("b", 0.0, -40.0, "south_0"), ego}), "c gg") << "behind ours";
}

}  // namespace
}  // namespace cdiff::simulation
