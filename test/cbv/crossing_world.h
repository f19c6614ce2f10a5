// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A crossing for CBV tests: the ego drives along y = 0 from x = 0 through a junction at x =
/// 100..110; roads from the south and the north (x = 105) turn into its exit.
#pragma once

#include <string>
#include <vector>

#include "cbv/cbv_selector.h"
#include "support/network_text.h"
#include "support/snapshot_builder.h"

namespace cdiff::cbv {

/// Lanes 4 m wide. Turns are straight diagonals of sqrt(50) m from (105, -+5) to (110, 0).
inline test::NetworkText crossingText() {
  test::NetworkText text;
  text.edge("west", {"0,0 100,0"}, "w", "j").edge("east", {"110,0 300,0"}, "j", "e");
  text.edge("further", {"310,0 400,0"}, "e", "f");
  text.edge("south", {"105,-105 105,-5"}, "s", "j").edge("north", {"105,105 105,5"}, "n", "j");
  text.edge("back", {"100,6 0,6"}, "j", "w");           // the other way
  text.edge("alley", {"125,-60 125,-8"}, "x", "y");     // points at the ego's route, leads nowhere
  text.edge("bridge", {"70,-60,8 70,60,8"}, "p", "q");  // crosses above
  text.edge(":j_0", {"100,0 110,0"}).edge(":j_1", {"105,-5 110,0"}).edge(":j_2", {"105,5 110,0"});
  text.edge(":e_0", {"300,0 310,0"});
  text.junction("j", "100,-5 100,8 110,5 110,-5").junction("e", "300,-2 300,2 310,2 310,-2");
  text.connection("west_0", "east_0", ":j_0_0").connection("south_0", "east_0", ":j_1_0", 'r');
  text.connection("north_0", "east_0", ":j_2_0", 'l').connection("east_0", "further_0", ":e_0_0");
  return text;
}

/// Network, ego route (x = 0..290: arc length = x) and a selector.
struct CrossingWorld {
  explicit CrossingWorld(const CbvOptions& options = {}, int max_cbv = 2,
                         const test::NetworkText& text = crossingText())
      : network(text.network()), graph(network), selector(options, max_cbv, graph, route) {}

  map::RoadNetwork network;
  map::LaneGraph graph;
  map::Route route = graph.toRoute(
      {{network.findLane("west_0"), network.findLane(":j_0_0"), network.findLane("east_0")}, 290.0},
      0.0, 180.0);
  CbvSelector selector;
};

/// The ego at `x` with 10 m/s and others, at a tick of 0.05 s.
inline traffic::TrafficSnapshot crossingSnapshot(std::uint64_t tick, double ego_x,
                                                 const std::vector<traffic::Vehicle>& others) {
  traffic::TrafficSnapshot snapshot = test::snapshotWithEgo(tick, {ego_x, 0.0, 0.0, 10.0});
  snapshot.vehicles.insert(snapshot.vehicles.end(), others.begin(), others.end());
  return snapshot;
}

inline traffic::Vehicle fromSouth(const std::string& id, double y, double speed) {
  return test::vehicle(id, {105.0, y, 90.0, speed});
}
inline traffic::Vehicle fromNorth(const std::string& id, double y, double speed) {
  return test::vehicle(id, {105.0, y, -90.0, speed});
}

/// Reason of a rejection; empty when the vehicle is not among the rejected.
inline std::string reasonOf(const CbvSelection& selection, const std::string& id) {
  for (const RejectedCandidate& rejected : selection.rejected) {
    if (rejected.vehicle_id == id) return rejected.reason;
  }
  return "";
}

}  // namespace cdiff::cbv
