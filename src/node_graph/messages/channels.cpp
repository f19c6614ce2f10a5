// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/messages/channels.h"

#include "e2e_cdiff/AckermannCommand.h"
#include "e2e_cdiff/GuidanceReport.h"
#include "e2e_cdiff/Heartbeat.h"
#include "e2e_cdiff/TickAck.h"
#include "e2e_cdiff/TrackedObjects.h"
#include "geometry_msgs/Twist.h"
#include "nav_msgs/Path.h"
#include "node_graph/messages/channel_conversions.h"
#include "rosgraph_msgs/Clock.h"
#include "sensor_msgs/LaserScan.h"
#include "sensor_msgs/PointCloud2.h"
#include "std_msgs/Float64.h"
#include "visualization_msgs/MarkerArray.h"

namespace cdiff::node_graph {
namespace {

using Graph = SessionGraph;

// Conditions.
constexpr Condition kAlways = {"", [](const Graph&) { return true; }};
constexpr Condition kRecordsDecisions = {
    "where answers may be late or a planner is external",
    [](const Graph& graph) { return graph.recordsDecisions(); }};
constexpr Condition kNoRecords = {"where there is no decision record",
                                  [](const Graph& graph) { return !graph.recordsDecisions(); }};
constexpr Condition kOwnCbvs = {"where the CBVs' planner is not external",
                                [](const Graph& graph) { return !graph.external_cbvs; }};
constexpr Condition kOwnCbvsPaced = {
    "with `real_time_factor`, where the CBVs' planner is not external",
    [](const Graph& graph) { return graph.paced && !graph.external_cbvs; }};
constexpr Condition kGuided = {"where the CBVs' planner is guided",
                               [](const Graph& graph) { return graph.cbvs_guided; }};
constexpr Condition kMeasured = {"where `metrics_node` takes part",
                                 [](const Graph& graph) { return graph.has(kMetricsNode); }};
constexpr Condition kEgoShown = {"where the ego's planner sees, and with `camera:=true`",
                                 [](const Graph& graph) { return graph.imagesOfEgo(); }};
constexpr Condition kCbvsShown = {"where the CBVs' planner sees, and with `camera:=true`",
                                  [](const Graph& graph) { return graph.imagesOfCbvs(); }};
constexpr Condition kEgoSees = {"where the planner sees",
                                [](const Graph& graph) { return graph.egoPlansFromImages(); }};
constexpr Condition kCbvsSee = {"where the planner sees",
                                [](const Graph& graph) { return graph.cbvsPlanFromImages(); }};

constexpr Condition kByAckermann = {"where `ego.command` is `ackermann`", [](const Graph& graph) {
                                      return graph.commandedBy("ackermann");
                                    }};
constexpr Condition kByTrajectory = {"where `ego.command` is `trajectory`", [](const Graph& graph) {
                                       return graph.commandedBy("trajectory");
                                     }};
constexpr Condition kByVelocity = {"where `ego.command` is `cmd_vel`",
                                   [](const Graph& graph) { return graph.commandedBy("cmd_vel"); }};

/// Builds a row; what is not set stays as for a topic that no tick waits for and no bag holds.
class Row {
 public:
  template <class Message>
  static Row of(ChannelId id, const char* name, Party publisher, const char* help) {
    return Row({id,
                name,
                Scope::kSession,
                messageType<Message>(),
                false,
                Use::kOther,
                publisher,
                kAlways,
                {},
                Need::kNothing,
                Recorded::kNever,
                nullptr,
                nullptr,
                nullptr,
                help});
  }
  /// Of the ego, or of each slot where the name holds a K.
  Row& vehicle() {
    const bool slots = std::string(row_.name).find('K') != std::string::npos;
    row_.scope = slots ? Scope::kSlot : Scope::kEgo;
    return *this;
  }
  /// And of each camera of the vehicle's rig.
  Row& perCamera() {
    row_.per_camera = true;
    return *this;
  }
  Row& latched() {
    row_.latched = true;
    return *this;
  }
  Row& where(const Condition& published) {
    row_.published = published;
    return *this;
  }
  Row& heardBy(Party party, const Condition& when = kAlways) {
    row_.listeners.push_back({party, when});
    return *this;
  }
  /// All nodes that follow the ticks.
  Row& heardByAll() {
    for (const Party party : {Party::kIdentification, Party::kCamera, Party::kEgoPlanner,
                              Party::kCbvPlanner, Party::kMetrics, Party::kRecorder})
      heardBy(party);
    return *this;
  }
  Row& observed(const Condition& when = kAlways) {
    return heardBy(Party::kMetrics, when).heardBy(Party::kRecorder, when);
  }
  Row& recorded(Recorded when, Use use = Use::kOther) {
    row_.recorded = when;
    row_.use = use;
    return *this;
  }
  /// Collected at each decision.
  Row& answer(Need need) {
    row_.need = need;
    return recorded(Recorded::kDecision, Use::kAnswer);
  }
  Row& converted(MakeMessage make, TakeAnswer take = nullptr) {
    row_.make = make;
    row_.take = take;
    return *this;
  }
  /// Of an external ego, one way to command of several.
  Row& command(const Condition& chosen) {
    row_.use = Use::kCommand;
    return vehicle().where(chosen).heardBy(Party::kSimulator, chosen);
  }
  /// Recorded, made of other messages.
  Row& derived(DeriveMessage derive, Recorded when = Recorded::kDecision) {
    row_.derive = derive;
    return recorded(when);
  }
  operator Channel() const { return row_; }  // NOLINT: a row is a channel

 private:
  explicit Row(Channel row) : row_(std::move(row)) {}
  Channel row_;
};

using Rows = std::vector<Channel>;
using visualization_msgs::MarkerArray;

Rows setUpRows() {
  return {Row::of<rosgraph_msgs::Clock>(ChannelId::kClock, "/clock", Party::kSimulator,
                                        "Simulated time, at every tick."),
          Row::of<msgs::Heartbeat>(ChannelId::kHeartbeat, "heartbeat", Party::kSimulator,
                                   "Sign of life of the simulator once a second; all nodes listen.")
              .latched(),
          Row::of<msgs::SessionInfo>(ChannelId::kSession, "session", Party::kSimulator,
                                     "Resolved scenario, network, route and who takes part.")
              .latched()
              .heardByAll()
              .recorded(Recorded::kOnce, Use::kSetUp),
          Row::of<nav_msgs::Path>(ChannelId::kEgoRoute, "ego/route", Party::kSimulator,
                                  "Route that the ego follows.")
              .vehicle()
              .latched()
              .heardBy(Party::kIdentification)
              .heardBy(Party::kEgoPlanner)
              .heardBy(Party::kRecorder)
              .recorded(Recorded::kOnce, Use::kSetUp)};
}

Rows tickRows() {
  return {
      Row::of<msgs::TrafficSnapshot>(ChannelId::kTraffic, "traffic", Party::kSimulator,
                                     "Every vehicle at a tick, and how the session stands.")
          .latched()
          .heardByAll()
          .recorded(Recorded::kTick, Use::kTick)
          .converted(&makeTraffic),
      Row::of<msgs::DecisionRecord>(
          ChannelId::kDecisionRecord, "decision_record", Party::kSimulator,
          "Which answers to a decision came, when, and what drove each vehicle.")
          .where(kRecordsDecisions)
          .observed(kRecordsDecisions)
          .answer(Need::kRecord)
          .converted(nullptr, &takeDecision),
      Row::of<msgs::CbvSelection>(ChannelId::kSelection, "cbv/selection", Party::kIdentification,
                                  "Vehicle, conflict point and route of each occupied slot.")
          .latched()
          .heardBy(Party::kSimulator)
          .heardBy(Party::kCamera, kCbvsShown)
          .heardBy(Party::kCbvPlanner)
          .observed()
          .answer(Need::kDecision)
          .converted(&makeSelection)};
}

Rows egoRows() {
  return {
      Row::of<msgs::ControlAction>(ChannelId::kEgoControl, "ego/control", Party::kEgoPlanner,
                                   "Throttle, steer and brake of the ego.")
          .vehicle()
          .heardBy(Party::kSimulator)
          .observed(kNoRecords)
          .answer(Need::kVehicle)
          .converted(&makeControl, &takeControl),
      Row::of<msgs::AckermannCommand>(ChannelId::kEgoAckermann, "ego/ackermann", Party::kEgoPlanner,
                                      "Steering angle with speed or acceleration.")
          .command(kByAckermann),
      Row::of<nav_msgs::Path>(ChannelId::kEgoTrajectory, "ego/trajectory", Party::kEgoPlanner,
                              "Poses in `map`, each with the time at which the ego is there.")
          .command(kByTrajectory),
      Row::of<geometry_msgs::Twist>(ChannelId::kEgoVelocity, "ego/cmd_vel", Party::kEgoPlanner,
                                    "Speed `linear.x` and yaw rate `angular.z`.")
          .command(kByVelocity)};
}

Rows plannerRows() {
  return {Row::of<msgs::ControlAction>(ChannelId::kCbvControl, "cbv_K/control", Party::kCbvPlanner,
                                       "Throttle, steer and brake of the CBV of a slot.")
              .vehicle()
              .heardBy(Party::kSimulator)
              .observed(kNoRecords)
              .answer(Need::kVehicle)
              .converted(&makeControl, &takeControl),
          Row::of<msgs::Rollout>(ChannelId::kCbvRollout, "cbv_K/rollout", Party::kCbvPlanner,
                                 "Planned states and actions; empty where the planner makes none.")
              .vehicle()
              .where(kOwnCbvs)
              .heardBy(Party::kSimulator, kOwnCbvsPaced)
              .observed(kOwnCbvs)
              .answer(Need::kVehicle)
              .converted(&makeRollout, &takeRollout),
          Row::of<msgs::GuidanceReport>(ChannelId::kGuidance, "cbv/guidance", Party::kCbvPlanner,
                                        "What each guidance objective did to each CBV.")
              .where(kGuided)
              .observed(kGuided)
              .answer(Need::kAnyCbv)
              .converted(&makeGuidance, &takeGuidance)};
}

Row imageRow(ChannelId id, const char* name, const Condition& shown) {
  return Row::of<sensor_msgs::Image>(
             id, name, Party::kCamera,
             "Front view at a decision (rgb8); of another camera C of the rig on `camera_C`.")
      .vehicle()
      .perCamera()
      .where(shown)
      .answer(Need::kSight)
      .converted(&makeImage, &takeImage);
}

Channel cameraInfoRow(ChannelId id, const char* name, const Condition& shown) {
  return Row::of<sensor_msgs::CameraInfo>(id, name, Party::kCamera, "Intrinsics beside each image.")
      .vehicle()
      .perCamera()
      .where(shown)
      .derived(&deriveCameraInfo);
}

Rows cameraRows() {
  return {imageRow(ChannelId::kEgoImage, "ego/camera/image_raw", kEgoShown)
              .heardBy(Party::kEgoPlanner, kEgoSees)
              .heardBy(Party::kMetrics, kEgoSees)
              .heardBy(Party::kRecorder, kEgoShown),
          cameraInfoRow(ChannelId::kEgoCameraInfo, "ego/camera/camera_info", kEgoShown),
          imageRow(ChannelId::kCbvImage, "cbv_K/camera/image_raw", kCbvsShown)
              .heardBy(Party::kCbvPlanner, kCbvsSee)
              .heardBy(Party::kMetrics, kCbvsSee)
              .heardBy(Party::kRecorder, kCbvsShown),
          cameraInfoRow(ChannelId::kCbvCameraInfo, "cbv_K/camera/camera_info", kCbvsShown)};
}

Channel figureRow(ChannelId id, const char* name, const char* help) {
  return Row::of<std_msgs::Float64>(id, name, Party::kMetrics, help).vehicle();
}

Rows sensorRows() {
  return {Row::of<nav_msgs::Odometry>(ChannelId::kEgoOdometry, "ego/odometry", Party::kSimulator,
                                      "Pose and speed of the ego, with covariance.")
              .vehicle()
              .derived(&deriveOdometry, Recorded::kTick),
          Row::of<nav_msgs::Odometry>(ChannelId::kCbvOdometry, "cbv_K/odometry", Party::kSimulator,
                                      "The same of the CBV of a slot, while there is one.")
              .vehicle(),
          figureRow(ChannelId::kCbvTtc, "cbv_K/ttc",
                    "Time to collision of ego and CBV [s], NaN where they miss each other."),
          figureRow(ChannelId::kCbvGap, "cbv_K/gap", "Gap between their boxes [m]."),
          figureRow(ChannelId::kCbvScore, "cbv_K/score", "Interaction score at selection."),
          Row::of<msgs::TrackedObjects>(ChannelId::kEgoObjects, "ego/objects", Party::kSimulator,
                                        "True vehicles around the ego, at every tick.")
              .vehicle(),
          Row::of<MarkerArray>(ChannelId::kEgoObjectMarkers, "ego/objects/markers",
                               Party::kSimulator, "The same as boxes.")
              .vehicle(),
          Row::of<sensor_msgs::LaserScan>(ChannelId::kEgoScan, "ego/scan", Party::kSimulator,
                                          "True 2D laser scan, at decisions.")
              .vehicle(),
          Row::of<sensor_msgs::PointCloud2>(ChannelId::kEgoPoints, "ego/points", Party::kSimulator,
                                            "True sparse lidar cloud, at decisions.")
              .vehicle()};
}

Rows otherRows() {
  return {Row::of<msgs::MetricReport>(
              ChannelId::kMetrics, "metrics", Party::kMetrics,
              "Measures of a decision; those of the whole session once a second and at its end.")
              .heardBy(Party::kRecorder, kMeasured)
              .recorded(Recorded::kDecision, Use::kReport),
          Row::of<tf2_msgs::TFMessage>(ChannelId::kTransforms, "/tf", Party::kSimulator,
                                       "`map` to `<vehicle>/base_link` of ego and CBVs.")
              .derived(&deriveTransforms)};
}

Rows displayRows() {
  return {
      Row::of<msgs::TickAck>(ChannelId::kTickAck, "tick_ack", Party::kParticipants,
                             "How a node stands with a tick.")
          .heardBy(Party::kSimulator),
      Row::of<MarkerArray>(ChannelId::kMarkers, "markers", Party::kMetrics,
                           "What happens, for rviz, while anyone subscribes."),
      Row::of<MarkerArray>(ChannelId::kMapMarkers, "markers/map", Party::kMetrics,
                           "Roads and ego route for rviz, once anyone subscribes.")
          .latched(),
      Row::of<sensor_msgs::Image>(ChannelId::kFrontView, "front_view", Party::kMetrics,
                                  "What the nearest CBV sees, with its plan, for people, while "
                                  "anyone subscribes; before the first CBV what the ego sees."),
      Row::of<MarkerArray>(ChannelId::kRolloutMarkers, "markers/rollouts", Party::kCbvPlanner,
                           "Plans of CBVs for rviz, while anyone subscribes."),
      Row::of<MarkerArray>(ChannelId::kPerceptionMarkers, "markers/perception", Party::kEgoPlanner,
                           "What the ego's planner intends, attends to and believes to see, for "
                           "rviz, while anyone subscribes; empty where it does not say.")};
}

}  // namespace

const std::vector<Channel>& channels() {
  static const std::vector<Channel> table = [] {
    std::vector<Channel> all;
    for (const Rows& part : {setUpRows(), tickRows(), egoRows(), plannerRows(), cameraRows(),
                             otherRows(), sensorRows(), displayRows()}) {
      for (const Channel& row : part) all.push_back(row);
    }
    return all;
  }();
  return table;
}

const Channel& channel(ChannelId id) { return channels().at(static_cast<std::size_t>(id)); }

}  // namespace cdiff::node_graph
