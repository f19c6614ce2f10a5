// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Two streets that cross, with lights: "west" and "east" along x, "south" and "north" along y.
/// Links of the traffic light "lights": 0 from west, 1 from south.
#pragma once

#include <fstream>
#include <string>

#include "map/route_source.h"
#include "session/session_request.h"
#include "session/session_setup.h"
#include "support/network_text.h"
#include "support/snapshot_builder.h"
#include "support/temporary_folder.h"

namespace cdiff::test {

inline std::string crossingStreetsText() {
  return NetworkText()
      .edge("west", {"0,0 85,0"}, "a", "j")
      .edge("east", {"115,0 200,0"}, "j", "b")
      .edge("south", {"100,-100 100,-15"}, "c", "j")
      .edge("north", {"100,15 100,100"}, "j", "d")
      .edge(":j_0", {"85,0 115,0"})
      .edge(":j_1", {"100,-15 100,15"})
      .junction("j", "85,-5 85,5 115,5 115,-5", "traffic_light")
      .connection("west_0", "east_0", ":j_0_0", 's', "tl=\"lights\" linkIndex=\"0\"")
      .connection("south_0", "north_0", ":j_1_0", 's', "tl=\"lights\" linkIndex=\"1\"")
      .text();
}

/// The network, and the ego's route along x from x = 5 m to x = 195 m.
struct CrossingStreets {
  map::RoadNetwork network = map::RoadNetwork::fromText(crossingStreetsText(), "streets");
  map::LaneGraph graph{network};
  map::Route route = map::routeAlongEdges(graph, {"west", "east"}, 5.0, 5.0);
};

/// The same as a session's setup; SUMO cannot load the network.
class CrossingSetup {
 public:
  const session::SessionSetup& setup() const { return setup_; }

 private:
  session::ScenarioOptions options() const {
    const std::string file = (folder_.path() / "streets.net.xml").string();
    std::ofstream(file) << crossingStreetsText();
    session::ScenarioOptions options = session::defaultScenario();
    options.network = file;
    options.demand = "none";
    options.route.edges = {"west", "east"};
    return options;
  }

  TemporaryFolder folder_;
  session::SessionSetup setup_{options()};
};

}  // namespace cdiff::test
