// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// A crossing at x = 85 to 115 m: the ego's street along x (y = 0), another along y (x = 100 m). All
// boxes are 4.5 x 1.8 m; the ego's front is 2.25 m ahead of its center.
#include <gtest/gtest.h>

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

TEST_F(WaitChains, WithoutAnEgoThereIsNone) {
  snapshot_.vehicles.clear();
  EXPECT_TRUE(chain().waits.empty());
}

}  // namespace
}  // namespace cdiff::record
