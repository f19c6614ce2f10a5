// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Traffic lights: green for everybody who still yields, or SUMO's own program.
#include <gtest/gtest.h>

#include <set>

#include "simulation/crossing_world.h"

namespace cdiff {
namespace {

class Signals : public testing::Test {
 protected:
  Signals() : made_(makeLights(folder_)) {}
  static test::SumoNetwork makeLights(const test::TemporaryFolder& folder) {
    const std::string nodes =
        "<node id=\"c\" x=\"0\" y=\"0\" type=\"traffic_light\"/><node id=\"w\" x=\"-100\" y=\"0\"/>"
        "<node id=\"e\" x=\"100\" y=\"0\"/><node id=\"s\" x=\"0\" y=\"-100\"/><node id=\"n\" "
        "x=\"0\" y=\"100\"/>";
    const std::string edges =
        test::roadEdges("west", "w", "c", 2, 1) + test::roadEdges("east", "c", "e", 2, 1) +
        test::roadEdges("south", "s", "c", 2, 1) + test::roadEdges("north", "c", "n", 2, 1);
    return test::makeSumoNetwork(folder, nodes, edges);
  }
  /// States that the one light shows within 100 s.
  std::set<std::string> statesShown(bool green) {
    simulation::SumoSession session;
    session.network_file = made_.file;
    session.simulation_step = 0.5;
    session.lights_green = green;
    simulation::SumoSimulator simulator({}, session, made_.network);
    EXPECT_EQ(simulator.signals().size(), 1U);  // known before the first step
    std::set<std::string> states;
    for (int i = 0; i < 200; ++i) {
      simulator.step({});
      EXPECT_EQ(simulator.signals().size(), 1U);
      EXPECT_EQ(simulator.signals().front().id, "c");
      states.insert(simulator.signals().front().state);
    }
    return states;
  }

  test::TemporaryFolder folder_;
  test::SumoNetwork made_;
};

TEST_F(Signals, GreenForTheWholeSession) {
  // 4 approaches x 4 directions (right, straight, left, back) = 16 links.
  EXPECT_EQ(statesShown(true), std::set<std::string>{std::string(16, 'g')});
}

TEST_F(Signals, FollowTheProgram) {
  const std::set<std::string> states = statesShown(false);
  EXPECT_GE(states.size(), 4U);  // green and yellow for each of the two roads
  for (const std::string& state : states) EXPECT_EQ(state.size(), 16U);
}

}  // namespace
}  // namespace cdiff
