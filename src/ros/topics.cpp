// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/topics.h"

#include <algorithm>

namespace cdiff::ros {
namespace {

using Nodes = std::vector<std::string>;

Nodes listenersOfControl(const SessionGraph& graph) {
  if (graph.recordsDecisions()) return {kTrafficSimulatorNode};
  return {kTrafficSimulatorNode, kMetricsNode, kRecorderNode};
}

/// Who may listen to a topic of a slot, whether it takes part or not.
Nodes possibleListenersOfSlot(const std::string& topic, int slot, const SessionGraph& graph) {
  if (topic == cbvControlTopic(slot)) return listenersOfControl(graph);
  if (topic == cbvRolloutTopic(slot)) {
    return graph.paced ? Nodes{kTrafficSimulatorNode, kMetricsNode, kRecorderNode}
                       : Nodes{kMetricsNode, kRecorderNode};
  }
  if (topic != imageTopic(slot) || !graph.imagesOfCbvs()) return {};
  if (!graph.cbvsPlanFromImages()) return {kRecorderNode};
  return {kDiffusionPlannerNode, kMetricsNode, kRecorderNode};
}

/// Who may listen, whether it takes part or not.
Nodes possibleListeners(const std::string& topic, const SessionGraph& graph) {
  if (topic == kSessionTopic || topic == kTrafficTopic) {
    return {kCbvIdentificationNode, kCameraNode,  kEgoPlannerNode, kCbvPlannerNode,
            kDiffusionPlannerNode,  kMetricsNode, kRecorderNode};
  }
  if (topic == kEgoRouteTopic) return {kCbvIdentificationNode, kEgoPlannerNode, kRecorderNode};
  if (topic == kSelectionTopic) {
    return {kTrafficSimulatorNode, kCameraNode,  kCbvPlannerNode,
            kDiffusionPlannerNode, kMetricsNode, kRecorderNode};
  }
  if (topic == kEgoControlTopic) return listenersOfControl(graph);
  if (topic == kDecisionRecordTopic) return {kMetricsNode, kRecorderNode};
  if (topic == imageTopic(kEgoSlot) && graph.imagesOfEgo()) {
    return graph.egoPlansFromImages() ? Nodes{kEgoPlannerNode, kMetricsNode, kRecorderNode}
                                      : Nodes{kRecorderNode};
  }
  if (topic == kTickAckTopic) return {kTrafficSimulatorNode};
  if (topic == kMetricsTopic) return {kRecorderNode};
  if (topic == kGuidanceTopic) return {kMetricsNode, kRecorderNode};
  for (int slot = 0; slot < graph.max_cbv; ++slot) {
    const Nodes nodes = possibleListenersOfSlot(topic, slot, graph);
    if (!nodes.empty()) return nodes;
  }
  return {};
}

std::string vehicleTopics(int slot) {
  return slot == kEgoSlot ? "ego" : "cbv_" + std::to_string(slot);
}

}  // namespace

std::string cbvControlTopic(int slot) { return vehicleTopics(slot) + "/control"; }
std::string cbvRolloutTopic(int slot) { return vehicleTopics(slot) + "/rollout"; }
std::string imageTopic(int slot) { return vehicleTopics(slot) + "/camera/image_raw"; }
std::string cameraInfoTopic(int slot) { return vehicleTopics(slot) + "/camera/camera_info"; }

bool SessionGraph::has(const std::string& node) const {
  return std::find(participants.begin(), participants.end(), node) != participants.end();
}

std::vector<std::string> listeners(const std::string& topic, const SessionGraph& graph) {
  std::vector<std::string> nodes;
  for (const std::string& node : possibleListeners(topic, graph)) {
    if (node == kTrafficSimulatorNode || graph.has(node)) nodes.push_back(node);
  }
  return nodes;
}

std::string answererOf(const std::string& topic, const SessionGraph& graph) {
  if (topic == kSelectionTopic) return kCbvIdentificationNode;
  if (topic == kEgoControlTopic)
    return graph.external_ego ? "the external ego planner" : kEgoPlannerNode;
  return graph.cbvsSee() ? kDiffusionPlannerNode : kCbvPlannerNode;
}

std::vector<std::string> publishersOf(const std::string& topic, const SessionGraph& graph) {
  if (topic == kEgoControlTopic && graph.external_ego) return {};
  if (topic == kSessionTopic || topic == kTrafficTopic || topic == kEgoRouteTopic ||
      topic == kDecisionRecordTopic)
    return {kTrafficSimulatorNode};
  if (topic == kMetricsTopic) return {kMetricsNode};
  if (topic == kTickAckTopic) return graph.participants;
  const bool image = topic.find("/camera/") != std::string::npos;
  return {image ? kCameraNode : answererOf(topic, graph), kTrafficSimulatorNode};
}

bool isObserver(const std::string& node) { return node == kMetricsNode || node == kRecorderNode; }

}  // namespace cdiff::ros
