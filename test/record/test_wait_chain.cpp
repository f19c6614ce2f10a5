// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// A crossing at x = 85 to 115 m: the ego's street along x (y = 0), another along y (x = 100 m). All
// boxes are 4.5 x 1.8 m; the ego's front is 2.25 m ahead of its center.
#include <gtest/gtest.h>

#include <fstream>

#include "record/crossing_streets.h"
#include "record/logs/wait_chain.h"

namespace cdiff::record {
namespace {

using For = Wait::For;

class WaitChains : public testing::Test {
 protected:
  /// `ego`: x of its center.
  explicit WaitChains(double ego = 50.0) : snapshot_(test::snapshotWithEgo(0, {ego})) {
    snapshot_.vehicles[0].lane_id = "west_0";
  }
  void add(const std::string& id, const test::Motion& motion, const std::string& lane) {
    snapshot_.vehicles.push_back(test::vehicle(id, motion));
    snapshot_.vehicles.back().lane_id = lane;
  }
  void put(double x) { snapshot_.vehicles[0].state.position.x() = x; }
  WaitChain chain() const { return waitChain(snapshot_, streets_.network, streets_.route); }

  test::CrossingStreets streets_;
  traffic::TrafficSnapshot snapshot_;
};

void expectWait(const Wait& wait, const std::string& who, For reason, const std::string& obstacle,
                const std::string& junction) {
  EXPECT_EQ(wait.vehicle, who);
  EXPECT_EQ(wait.reason, reason) << who;
  EXPECT_EQ(wait.obstacle, obstacle) << who;
  EXPECT_EQ(wait.junction, junction) << who;
}

TEST_F(WaitChains, AFreeRoadIsNoReason) {
  add("beside", {55.0, 3.5}, "");
  add("oncoming", {60.0, 4.0, 180.0}, "");
  add("far", {80.0, 0.0}, "west_0");  // its rear is 25.5 m ahead of the front
  const WaitChain found = chain();
  ASSERT_EQ(found.waits.size(), 1U);
  expectWait(found.waits[0], "ego", For::kNothing, "", "");
  EXPECT_TRUE(found.queue().empty());
}

TEST_F(WaitChains, AQueueLeadsToItsHeadAndToWhatBlocksIt) {
  add("a", {65.0, 0.0}, "west_0");
  add("b", {80.0, 0.0}, "west_0");  // 2.75 m before the junction
  add("c", {100.0, 0.0, 90.0}, ":j_1_0");
  add("d", {100.0, 8.0, 90.0}, ":j_1_0");
  add("e", {100.0, 20.0, 90.0, 4.0}, "north_0");  // drives on
  const WaitChain found = chain();
  ASSERT_EQ(found.waits.size(), 5U);
  expectWait(found.waits[0], "ego", For::kVehicle, "a", "");
  expectWait(found.waits[1], "a", For::kVehicle, "b", "");
  expectWait(found.waits[2], "b", For::kVehicle, "c", "j");
  expectWait(found.waits[3], "c", For::kVehicle, "d", "j");
  expectWait(found.waits[4], "d", For::kVehicle, "e", "j");
  EXPECT_FALSE(found.ring);
  EXPECT_EQ(found.queue(), (std::vector<std::string>{"a", "b"}));
}

TEST_F(WaitChains, VehiclesThatWaitForEachOtherAreARing) {
  add("b", {62.0, 0.0}, "west_0");
  snapshot_.vehicles[1].state.position.x() = 80.0;
  put(70.0);
  add("c", {100.0, -20.0, 90.0}, "south_0");
  const WaitChain found = chain();
  ASSERT_EQ(found.waits.size(), 3U);
  expectWait(found.waits[1], "b", For::kVehicle, "c", "j");
  expectWait(found.waits[2], "c", For::kVehicle, "b", "j");
  EXPECT_TRUE(found.ring);
}

TEST_F(WaitChains, ALightStopsTheEgoAndTheHeadOfItsQueue) {
  put(80.0);
  snapshot_.signals = {{"lights", "rG"}};
  const WaitChain alone = chain();
  ASSERT_EQ(alone.waits.size(), 1U);
  expectWait(alone.waits[0], "ego", For::kLight, "lights", "j");
  put(65.0);
  add("b", {80.0, 0.0}, "west_0");
  add("c", {100.0, -20.0, 90.0}, "south_0");
  const WaitChain behind = chain();
  ASSERT_EQ(behind.waits.size(), 2U);
  expectWait(behind.waits[0], "ego", For::kVehicle, "b", "");
  expectWait(behind.waits[1], "b", For::kLight, "lights", "j");
  snapshot_.signals = {{"lights", "gr"}};
  expectWait(chain().waits.at(1), "b", For::kVehicle, "c", "j");
  expectWait(chain().waits.at(2), "c", For::kLight, "lights", "j");
}

TEST_F(WaitChains, WhoDrivesWaitsForNothing) {
  add("a", {60.0, 0.0, 0.0, 3.0}, "west_0");
  add("b", {66.0, 0.0}, "west_0");
  const WaitChain found = chain();
  ASSERT_EQ(found.waits.size(), 1U);
  expectWait(found.waits[0], "ego", For::kVehicle, "a", "");
}

TEST_F(WaitChains, AVehicleAcrossTheRouteAndOffTheLanesIsInTheWay) {
  add("askew", {58.0, 2.0, 90.0}, "");  // its outline reaches y = -0.25 m
  expectWait(chain().waits.at(0), "ego", For::kVehicle, "askew", "");
  expectWait(chain().waits.at(1), "askew", For::kNothing, "", "");
  snapshot_.vehicles[1].state.elevation = 5.0;  // on a bridge
  expectWait(chain().waits.at(0), "ego", For::kNothing, "", "");
}

// The route ends at x = 195 m.
TEST_F(WaitChains, AVehicleBeyondTheGoalIsInTheWay) {
  put(188.0);
  snapshot_.vehicles[0].lane_id = "east_0";
  add("after", {203.0, 0.0}, "east_0");
  expectWait(chain().waits.at(0), "ego", For::kVehicle, "after", "");
  snapshot_.vehicles[1].state.position.y() = 3.5;
  expectWait(chain().waits.at(0), "ego", For::kNothing, "", "");
}

// b's front is 2.75 m before the junction of 30 m. The vehicle behind it leaves 2.75 m, then 12.75
// m: b needs its 4.5 m and the gap of 3 m.
TEST_F(WaitChains, AVehicleBehindTheJunctionThatLeavesNoRoomIsInTheWay) {
  put(65.0);
  add("b", {80.0, 0.0}, "west_0");
  add("parked", {120.0, 0.0}, "east_0");
  ASSERT_EQ(chain().waits.size(), 3U);
  expectWait(chain().waits[1], "b", For::kVehicle, "parked", "j");
  expectWait(chain().waits[2], "parked", For::kNothing, "", "");
  snapshot_.vehicles[2].state.speed = 3.0;  // drives away
  expectWait(chain().waits.at(1), "b", For::kNothing, "", "j");
  snapshot_.vehicles[2] = test::vehicle("parked", {130.0});
  snapshot_.vehicles[2].lane_id = "east_0";
  expectWait(chain().waits.at(1), "b", For::kNothing, "", "j");
}

TEST_F(WaitChains, TheEgoIsHeldUpFromBehindTheJunctionToo) {
  put(80.0);
  add("parked", {120.0, 0.0}, "east_0");
  expectWait(chain().waits.at(0), "ego", For::kVehicle, "parked", "j");
  snapshot_.vehicles[1].state.position.x() = 130.0;
  expectWait(chain().waits.at(0), "ego", For::kNothing, "", "j");
}

TEST_F(WaitChains, ALaneThatLeadsNowhereIsAReason) {
  put(180.0);
  snapshot_.vehicles[0].lane_id = "east_0";
  add("last", {195.0, 0.0}, "east_0");
  expectWait(chain().waits.at(1), "last", For::kNoWay, "east_0", "");
}

// From west on to east or north, and a lane back from east to west beside the first.
class WaitChainsWithDemand : public WaitChains {
 protected:
  WaitChainsWithDemand() : WaitChains(65.0) {
    add("b", {80.0, 0.0}, "west_0");
    add("parked", {120.0, 0.0}, "east_0");  // its front is 7.25 m behind the lane's start
  }
  /// `route` of b, and where the other has a stop.
  WaitChain chainFor(const std::string& route, const std::string& stop, double clock) const {
    const std::string file = (folder_.path() / "cars.rou.xml").string();
    std::ofstream(file) << "<routes><vehicle id=\"b\" depart=\"0\"><route edges=\"" + route +
                               "\"/></vehicle><flow id=\"f\" begin=\"0\" number=\"1\"/>"
                               "<vehicle id=\"parked\" depart=\"0\"><route edges=\"east\"/>" +
                               stop + "</vehicle></routes>";
    const session::DemandFile demand(file);
    return waitChain(snapshot_, network_, streets_.route, {&demand, clock});
  }

  test::TemporaryFolder folder_;
  map::RoadNetwork network_ =
      map::RoadNetwork::fromText(test::NetworkText()
                                     .edge("west", {"0,0 85,0"}, "a", "j")
                                     .edge("east", {"115,0 200,0"}, "j", "b")
                                     .edge("north", {"100,15 100,100"}, "j", "d")
                                     .edge("back", {"200,5 115,5"}, "b", "j")
                                     .edge("away", {"85,5 0,5"}, "j", "a")
                                     .edge(":j_0", {"85,0 115,0"})
                                     .edge(":j_1", {"85,0 95,2 100,15"})
                                     .edge(":j_2", {"115,5 85,5"})
                                     .junction("j", "85,-5 85,10 115,10 115,-5")
                                     .connection("west_0", "east_0", ":j_0_0")
                                     .connection("west_0", "north_0", ":j_1_0", 'l')
                                     .connection("back_0", "away_0", ":j_2_0")
                                     .text(),
                                 "streets");
};

TEST_F(WaitChainsWithDemand, AVehicleIsHeldUpOnItsOwnRouteAlone) {
  expectWait(chainFor("west east", "", 0.0).waits.at(1), "b", For::kVehicle, "parked", "j");
  expectWait(chainFor("west north", "", 0.0).waits.at(1), "b", For::kNothing, "", "j");
  // Where nobody knows its route, the full exit is the best guess.
  expectWait(chainFor("elsewhere", "", 0.0).waits.at(1), "b", For::kVehicle, "parked", "j");
}

TEST_F(WaitChainsWithDemand, AStopOfTheDemandIsAReasonAsLongAsItLasts) {
  const std::string stop = "<stop lane=\"east_0\" startPos=\"0\" endPos=\"8\" until=\"600\"/>";
  const WaitChain during = chainFor("west east", stop, 599.0);
  expectWait(during.waits.at(2), "parked", For::kStop, "east_0", "");
  EXPECT_EQ(during.waits[2].until, "until 600 s of SUMO's clock");
  expectWait(chainFor("west east", stop, 601.0).waits.at(2), "parked", For::kNothing, "", "");
  const std::string elsewhere = "<stop lane=\"east_0\" startPos=\"-20\" endPos=\"-1\"/>";
  expectWait(chainFor("west east", elsewhere, 0.0).waits.at(2), "parked", For::kNothing, "", "");
}

TEST_F(WaitChainsWithDemand, OnlyWaysThatMeetItsOwnAreLetPass) {
  add("oncoming", {100.0, 5.0, 180.0}, ":j_2_0");
  expectWait(chainFor("west north", "", 0.0).waits.at(1), "b", For::kVehicle, "oncoming", "j");
  snapshot_.vehicles[2].state.position.x() = 150.0;  // room to the east
  expectWait(chainFor("west east", "", 0.0).waits.at(1), "b", For::kNothing, "", "j");
}

TEST_F(WaitChainsWithDemand, AVehicleYieldsToOneThatComes) {
  add("oncoming", {120.0, 5.0, 180.0, 4.0}, "back_0");
  const WaitChain found = chainFor("west north", "", 0.0);
  expectWait(found.waits.at(1), "b", For::kVehicle, "oncoming", "j");
  EXPECT_TRUE(found.waits[1].yields);
  EXPECT_FALSE(chainFor("west east", "", 0.0).waits.at(1).yields) << "blocked by parked";
}

TEST_F(WaitChains, WithoutAnEgoThereIsNone) {
  snapshot_.vehicles.clear();
  EXPECT_TRUE(chain().waits.empty());
}

}  // namespace
}  // namespace cdiff::record
