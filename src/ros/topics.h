// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Names of nodes and topics, and who listens to what: the table behind the start barrier.
#pragma once

#include <string>
#include <vector>

namespace cdiff::ros {

// Nodes, without namespace.
inline constexpr const char* kTrafficSimulatorNode = "traffic_simulator_node";
inline constexpr const char* kCbvIdentificationNode = "cbv_identification_node";
inline constexpr const char* kEgoPlannerNode = "ego_planner_node";
inline constexpr const char* kCbvPlannerNode = "cbv_planner_node";
inline constexpr const char* kDiffusionPlannerNode = "diffusion_planner_node";  ///< instead of it
inline constexpr const char* kCameraNode = "camera_node";
inline constexpr const char* kMetricsNode = "metrics_node";
inline constexpr const char* kRecorderNode = "recorder_node";

// Topics, relative to the session's namespace.
inline constexpr const char* kSessionTopic = "session";           ///< SessionInfo, latched
inline constexpr const char* kTrafficTopic = "traffic";           ///< TrafficSnapshot, every tick
inline constexpr const char* kEgoRouteTopic = "ego/route";        ///< nav_msgs/Path, latched
inline constexpr const char* kEgoOdometryTopic = "ego/odometry";  ///< nav_msgs/Odometry
inline constexpr const char* kEgoControlTopic = "ego/control";    ///< ControlAction
inline constexpr const char* kSelectionTopic = "cbv/selection";   ///< CbvSelection
inline constexpr const char* kMetricsTopic = "metrics";           ///< MetricReport
inline constexpr const char* kTickAckTopic = "tick_ack";          ///< TickAck
inline constexpr const char* kHeartbeatTopic = "heartbeat";       ///< Heartbeat, latched
inline constexpr const char* kGuidanceTopic = "cbv/guidance";     ///< GuidanceReport
inline constexpr const char* kDecisionRecordTopic = "decision_record";  ///< DecisionRecord
inline constexpr const char* kMarkersTopic = "markers";         ///< visualization_msgs/MarkerArray
inline constexpr const char* kMapMarkersTopic = "markers/map";  ///< the same, latched
inline constexpr const char* kRolloutMarkersTopic = "markers/rollouts";  ///< the same
/// Slot number of the ego where slots name vehicles.
inline constexpr int kEgoSlot = -1;
/// ControlAction of a slot.
std::string cbvControlTopic(int slot);
/// Rollout of a slot.
std::string cbvRolloutTopic(int slot);
/// sensor_msgs/Image of a slot, or of the ego (kEgoSlot).
std::string imageTopic(int slot);
/// sensor_msgs/CameraInfo beside it.
std::string cameraInfoTopic(int slot);

/// Who takes part in a session, besides the traffic simulator.
struct SessionGraph {
  std::vector<std::string> participants;  ///< nodes that the session counts on
  int max_cbv = 0;                        ///< slots
  bool external_ego = false;              ///< the user's own node drives the ego
  bool ego_sees = false;                  ///< the ego's planner needs images
  bool show_cameras = false;              ///< images of ego and CBVs even where no planner sees
  bool paced = false;                     ///< the wall clock rules: late answers are replaced

  bool has(const std::string& node) const;
  /// Whether the traffic simulator publishes which answers counted at each decision; observers take
  /// the controls from there.
  bool recordsDecisions() const { return paced || external_ego; }
  /// Whether the planner of the CBVs needs images.
  bool cbvsSee() const { return has(kDiffusionPlannerNode); }
  /// Whether camera_node publishes images of the slots, or of the ego.
  bool imagesOfCbvs() const { return has(kCameraNode) && (cbvsSee() || show_cameras); }
  bool imagesOfEgo() const { return has(kCameraNode) && (ego_sees || show_cameras); }
  /// Whether these images are what the planner of the CBVs, or of the ego, plans from.
  bool cbvsPlanFromImages() const { return has(kCameraNode) && cbvsSee(); }
  bool egoPlansFromImages() const { return has(kCameraNode) && ego_sees; }
};

/// Nodes that listen to a topic in this session, by name; a publisher waits for them before the
/// first tick.
std::vector<std::string> listeners(const std::string& topic, const SessionGraph& graph);

/// Who answers on a topic, for messages to people: "cbv_planner_node",
/// "diffusion_planner_node", or the user's own ego
/// planner.
std::string answererOf(const std::string& topic, const SessionGraph& graph);

/// The nodes whose messages count on a topic, without namespace: its publisher, and the traffic
/// simulator, in whose name a replay publishes everything. Empty where whoever comes first counts
/// (the control of an external ego).
std::vector<std::string> publishersOf(const std::string& topic, const SessionGraph& graph);

/// Whether a node acknowledges every tick (metrics and recorder do).
bool isObserver(const std::string& node);

}  // namespace cdiff::ros
