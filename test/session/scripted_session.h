// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A session on a straight road without SUMO: 600 m along x, 4 m wide, the ego's box (4.5 x 1.8 m)
/// at x = 100 m. Vehicles are placed before the world starts.
#pragma once

#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "session/world.h"
#include "support/network_text.h"
#include "support/scripted_simulator.h"
#include "support/temporary_folder.h"

namespace cdiff::test {

class ScriptedSession {
 public:
  /// `at_most` times real time; 0 is without limit.
  explicit ScriptedSession(double start_speed = 0.0, double at_most = 0.0)
      : setup_(scenario(start_speed, at_most)) {}

  const session::SessionSetup& setup() const { return setup_; }
  /// Of the world to come, and of it as long as it is there.
  ScriptedSimulator& simulator() { return *simulator_; }
  /// A session has one.
  std::unique_ptr<session::World> makeWorld() {
    return std::make_unique<session::World>(setup_, std::move(owned_));
  }
  /// Takes `id` over in slot 0, to follow the ego's route.
  cbv::CbvSelection selectionOf(const std::string& id) const {
    cbv::CbvSelection selection;
    selection.assignments.emplace_back();
    selection.assignments.back().vehicle_id = id;
    selection.assignments.back().conflict_aware_route = setup_.egoRoute();
    return selection;
  }

 private:
  session::ScenarioOptions scenario(double start_speed, double at_most) const {
    const std::filesystem::path file = folder_.path() / "road.net.xml";
    std::ofstream(file) << NetworkText().edge("road", {"0,0 600,0"}).text();
    session::ScenarioOptions options;
    options.network = file.string();
    options.demand = "none";
    options.cbv_planner = options.ego_planner;
    options.route.edges = {"road"};
    options.route.start_offset = 100.0;
    options.route.start_speed = start_speed;
    options.traffic.clear_start = 0.0;
    options.at_most = at_most;
    return options;
  }

  TemporaryFolder folder_;
  session::SessionSetup setup_;
  std::unique_ptr<ScriptedSimulator> owned_ = std::make_unique<ScriptedSimulator>();
  ScriptedSimulator* simulator_ = owned_.get();
};

}  // namespace cdiff::test
