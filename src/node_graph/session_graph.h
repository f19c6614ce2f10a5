// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "e2e_cdiff/SessionInfo.h"
#include "session/session_setup.h"

namespace cdiff::node_graph {

// Names of the nodes, without namespace.
inline constexpr const char* kTrafficSimulatorNode = "traffic_simulator_node";
inline constexpr const char* kCbvIdentificationNode = "cbv_identification_node";
inline constexpr const char* kEgoPlannerNode = "ego_planner_node";
inline constexpr const char* kCbvPlannerNode = "cbv_planner_node";
inline constexpr const char* kDiffusionPlannerNode = "diffusion_planner_node";  ///< where it sees
inline constexpr const char* kCameraNode = "camera_node";
inline constexpr const char* kMetricsNode = "metrics_node";
inline constexpr const char* kRecorderNode = "recorder_node";
inline constexpr const char* kSceneNode = "scene_node";  ///< takes part in no session

using traffic::kEgoSlot;

/// The part that a node plays in a session.
enum class Party {
  kSimulator,
  kIdentification,
  kEgoPlanner,
  kCbvPlanner,
  kCamera,
  kMetrics,
  kRecorder,
  kParticipants  ///< every node but the traffic simulator
};

/// Which nodes take part in a session besides the traffic simulator, and what their planners need.
struct SessionGraph {
  std::vector<std::string> participants;  ///< nodes that the session counts on
  int max_cbv = 0;                        ///< slots
  bool external_ego = false;              ///< the user's own node drives the ego
  bool external_cbvs = false;             ///< the user's own nodes drive the CBVs
  std::string ego_command = "control";    ///< how the external ego commands (ego.command)
  bool ego_sees = false;                  ///< the ego's planner needs images
  bool show_cameras = false;              ///< images of ego and CBVs even where no planner sees
  bool paced = false;                     ///< the wall clock rules: late answers are replaced
  bool cbvs_see = false;                  ///< the planner of the CBVs needs images
  bool cbvs_guided = false;               ///< the planner of the CBVs follows objectives
  std::string cbv_planner_node = kCbvPlannerNode;
  session::VehicleRigs rigs = {};  ///< cameras of ego and slots

  bool has(const std::string& node) const;
  /// Whether an external ego commands in this way.
  bool commandedBy(const char* command) const { return external_ego && ego_command == command; }
  /// Whether a node of the user's own drives the vehicles of a part.
  bool external(Party party) const {
    return (party == Party::kEgoPlanner && external_ego) ||
           (party == Party::kCbvPlanner && external_cbvs);
  }
  /// Whether the traffic simulator publishes which answers counted at each decision; observers take
  /// the controls from there.
  bool recordsDecisions() const { return paced || external_ego || external_cbvs; }
  /// Whether camera_node publishes images of the slots, or of the ego.
  bool imagesOfCbvs() const { return has(kCameraNode) && (cbvs_see || show_cameras); }
  bool imagesOfEgo() const { return has(kCameraNode) && (ego_sees || show_cameras); }
  /// Whether these images are what the planner of the CBVs, or of the ego, plans from.
  bool cbvsPlanFromImages() const { return has(kCameraNode) && cbvs_see; }
  bool egoPlansFromImages() const { return has(kCameraNode) && ego_sees; }
};

/// The node that plays a part; for a node of the user's own "the external ego planner" or "the
/// external CBV planner". Throws
/// std::logic_error for kParticipants, which are many.
std::string nodeOf(Party party, const SessionGraph& graph);

/// Whether a node acknowledges every tick (metrics and recorder do).
bool isObserver(const std::string& node);

// What nodes make of a SessionInfo: the setup, and who takes part.

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

}  // namespace cdiff::node_graph
