// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/session_graph.h"

#include <algorithm>
#include <stdexcept>

#include "node_graph/messages/session_conversions.h"
#include "node_graph/messages/traffic_conversions.h"
#include "planners/registry.h"

namespace cdiff::node_graph {

bool SessionGraph::has(const std::string& node) const {
  return std::find(participants.begin(), participants.end(), node) != participants.end();
}

std::string nodeOf(Party party, const SessionGraph& graph) {
  switch (party) {
    case Party::kSimulator:
      return kTrafficSimulatorNode;
    case Party::kIdentification:
      return kCbvIdentificationNode;
    case Party::kEgoPlanner:
      return graph.external_ego ? "the external ego planner" : kEgoPlannerNode;
    case Party::kCbvPlanner:
      return graph.external_cbvs ? "the external CBV planner" : graph.cbv_planner_node;
    case Party::kCamera:
      return kCameraNode;
    case Party::kMetrics:
      return kMetricsNode;
    case Party::kRecorder:
      return kRecorderNode;
    case Party::kParticipants:
      break;
  }
  throw std::logic_error("no single node plays this part");
}

bool isObserver(const std::string& node) { return node == kMetricsNode || node == kRecorderNode; }

namespace {

/// The program that the planner's descriptor names.
std::string cbvPlannerNode(const session::ScenarioOptions& options) {
  const planning::PlannerDescriptor* planner = planners::findPlanner(options.cbv_planner);
  return planner == nullptr ? kCbvPlannerNode : planner->cbv_node;
}

std::vector<std::string> neededNodes(const session::ScenarioOptions& options,
                                     const GraphRequest& request) {
  std::vector<std::string> nodes = {kCbvIdentificationNode, kEgoPlannerNode,
                                    cbvPlannerNode(options), kMetricsNode};
  if (planners::seesImages(options.cbv_planner) || planners::seesImages(options.ego_planner) ||
      request.show_cameras)
    nodes.emplace_back(kCameraNode);
  if (request.record) nodes.emplace_back(kRecorderNode);
  return nodes;
}

/// What follows from the scenario; who takes part says which program runs the CBVs' planner.
void addCbvPlanner(const session::ScenarioOptions& options, SessionGraph& graph) {
  graph.external_cbvs = options.cbv_planner == planning::kExternalPlanner;
  graph.cbvs_see = planners::seesImages(options.cbv_planner);
  graph.cbvs_guided = planners::canBeGuided(options.cbv_planner);
  graph.cbv_planner_node = cbvPlannerNode(options);
  for (const char* node : {kDiffusionPlannerNode, kCbvPlannerNode}) {
    if (!graph.has(graph.cbv_planner_node) && graph.has(node)) graph.cbv_planner_node = node;
  }
}

}  // namespace

std::unique_ptr<session::SessionSetup> setupOf(const msgs::SessionInfo& info) {
  return std::make_unique<session::SessionSetup>(optionsFromMsg(info), importFromMsg(info),
                                                 routeFromMsg(info));
}

SessionGraph graphOf(const session::ScenarioOptions& options, const GraphRequest& request,
                     const std::vector<std::string>& participants) {
  SessionGraph graph;
  graph.max_cbv = static_cast<int>(options.max_cbv);
  graph.external_ego = options.ego_planner == planning::kExternalPlanner;
  graph.ego_command = options.ego.command;
  graph.ego_sees = planners::seesImages(options.ego_planner);
  graph.show_cameras = request.show_cameras;
  graph.paced = options.real_time_factor > 0.0;
  graph.rigs = session::VehicleRigs(options);
  const bool external_cbvs = options.cbv_planner == planning::kExternalPlanner;
  for (const std::string& node :
       participants.empty() ? neededNodes(options, request) : participants) {
    const bool of_user = (node == kEgoPlannerNode && graph.external_ego) ||
                         (node == cbvPlannerNode(options) && external_cbvs);
    if (!of_user) graph.participants.push_back(node);
  }
  addCbvPlanner(options, graph);
  return graph;
}

void putGraph(const SessionGraph& graph, msgs::SessionInfo& info) {
  info.participants = graph.participants;
  info.external_ego = graph.external_ego;
  info.ego_sees = graph.ego_sees;
  info.show_cameras = graph.show_cameras;
}

SessionGraph graphOf(const msgs::SessionInfo& info) {
  SessionGraph graph;
  graph.participants = info.participants;
  const session::ScenarioOptions options = optionsFromMsg(info);
  graph.max_cbv = static_cast<int>(options.max_cbv);
  graph.paced = options.real_time_factor > 0.0;
  graph.rigs = session::VehicleRigs(options);
  graph.external_ego = info.external_ego != 0;
  graph.ego_command = options.ego.command;
  graph.ego_sees = info.ego_sees != 0;
  graph.show_cameras = info.show_cameras != 0;
  addCbvPlanner(options, graph);
  return graph;
}

}  // namespace cdiff::node_graph
