// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What nodes make of a SessionInfo: the setup, and who takes part.
#pragma once

#include <memory>
#include <string>

#include "e2e_cdiff/SessionInfo.h"
#include "ros/session_graph.h"
#include "session/session_setup.h"

namespace cdiff::ros {

std::unique_ptr<session::SessionSetup> setupOf(const ::e2e_cdiff::SessionInfo& info);

/// What launch files and parameters add to the scenario.
struct GraphRequest {
  bool record = false;        ///< a bag
  bool show_cameras = false;  ///< images where no planner sees
};

/// The nodes that a scenario needs. `participants` replaces the list when it is not empty.
SessionGraph graphOf(const session::ScenarioOptions& options, const GraphRequest& request,
                     const std::vector<std::string>& participants = {});
/// Writes the graph into a session's message, and reads it. What the planner of the CBVs needs
/// follows from the scenario in it.
void putGraph(const SessionGraph& graph, ::e2e_cdiff::SessionInfo& info);
SessionGraph graphOf(const ::e2e_cdiff::SessionInfo& info);

}  // namespace cdiff::ros
