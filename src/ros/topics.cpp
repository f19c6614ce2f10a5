// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/ros/topics.h"

#include <algorithm>

namespace cdiff::ros {
namespace {

/// Who may listen, whether it takes part or not.
std::vector<std::string> possibleListeners(const std::string& topic, int max_cbv) {
  if (topic == kSessionTopic || topic == kTrafficTopic) {
    return {kCbvIdentificationNode, kEgoPlannerNode, kCbvPlannerNode, kMetricsNode, kRecorderNode};
  }
  if (topic == kEgoRouteTopic) return {kCbvIdentificationNode, kEgoPlannerNode, kRecorderNode};
  if (topic == kSelectionTopic)
    return {kTrafficSimulatorNode, kCbvPlannerNode, kMetricsNode, kRecorderNode};
  if (topic == kEgoControlTopic) return {kTrafficSimulatorNode, kMetricsNode, kRecorderNode};
  if (topic == kTickAckTopic) return {kTrafficSimulatorNode};
  if (topic == kMetricsTopic) return {kRecorderNode};
  for (int slot = 0; slot < max_cbv; ++slot) {
    if (topic == cbvControlTopic(slot)) return {kTrafficSimulatorNode, kMetricsNode, kRecorderNode};
    if (topic == cbvRolloutTopic(slot)) return {kRecorderNode};
  }
  return {};
}

}  // namespace

std::string cbvControlTopic(int slot) { return "cbv_" + std::to_string(slot) + "/control"; }
std::string cbvRolloutTopic(int slot) { return "cbv_" + std::to_string(slot) + "/rollout"; }

bool SessionGraph::has(const std::string& node) const {
  return std::find(participants.begin(), participants.end(), node) != participants.end();
}

std::vector<std::string> listeners(const std::string& topic, const SessionGraph& graph) {
  std::vector<std::string> nodes;
  for (const std::string& node : possibleListeners(topic, graph.max_cbv)) {
    if (node == kTrafficSimulatorNode || graph.has(node)) nodes.push_back(node);
  }
  return nodes;
}

std::string answererOf(const std::string& topic, const SessionGraph& graph) {
  if (topic == kSelectionTopic) return kCbvIdentificationNode;
  if (topic == kEgoControlTopic)
    return graph.external_ego ? "the external ego planner" : kEgoPlannerNode;
  return kCbvPlannerNode;
}

bool isObserver(const std::string& node) { return node == kMetricsNode || node == kRecorderNode; }

}  // namespace cdiff::ros
