// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Two levels: the ego drives below a bridge that others cross.
#include <gtest/gtest.h>

#include <fstream>

#include "session/closed_loop.h"
#include "simulation/crossing_world.h"

namespace cdiff::session {
namespace {

/// Counts boxes that overlap the ego's in the plane, whatever their height, and contacts.
class OverlapCount : public SessionObserver {
 public:
  void observe(const TickRecord& record) override {
    const traffic::Vehicle* ego = record.snapshot->ego();
    if (ego == nullptr) return;
    for (const traffic::Vehicle& other : record.snapshot->vehicles) {
      if (other.id == ego->id || !geometry::overlap(ego->box(), other.box())) continue;
      ++overlaps;
      EXPECT_NEAR(other.state.elevation - ego->state.elevation, 8.0, 0.5) << other.id;
    }
    contacts += record.snapshot->contacts.size();
  }
  std::size_t overlaps = 0;
  std::size_t contacts = 0;
};

// The bridge passes 8 m above the major road at x = -30 m; a car crosses it every second in each
// direction, so some are above the ego while it passes below.
TEST(Levels, VehiclesOnTwoLevelsDoNotCollide) {
  const test::TemporaryFolder folder;
  const test::SumoNetwork made = test::makeCrossing(folder, true);
  const std::string demand = (folder.path() / "bridge.rou.xml").string();
  std::ofstream(demand)
      << "<routes><flow id=\"up\" begin=\"0\" end=\"90\" period=\"1\" departSpeed=\"max\"><route "
         "edges=\"bridge\"/></flow><flow id=\"down\" begin=\"0\" end=\"90\" period=\"1\" "
         "departSpeed=\"max\"><route edges=\"bridge_back\"/></flow></routes>";
  ScenarioOptions options;
  options.cbv_planner = "pdm_lite";
  options.network = made.file.string();
  options.demand = demand;
  options.route.edges = {"west", "east"};
  options.route.start_offset = 100.0;
  options.max_cbv = 0;
  const SessionSetup setup(options);
  ClosedLoop loop(setup);
  OverlapCount count;
  loop.addObserver(count);
  const std::atomic<bool> stop{false};
  EXPECT_EQ(loop.run(stop), traffic::SessionStatus::kCompleted);
  EXPECT_GT(count.overlaps, 0u) << "the test needs a car above the ego";
  EXPECT_EQ(count.contacts, 0u);
}

}  // namespace
}  // namespace cdiff::session
