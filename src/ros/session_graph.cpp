// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/session_graph.h"

#include <algorithm>
#include <stdexcept>

namespace cdiff::ros {

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
      return graph.cbv_planner_node;
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

}  // namespace cdiff::ros
