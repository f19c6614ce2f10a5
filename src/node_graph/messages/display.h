// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "e2e_cdiff/MetricReport.h"
#include "e2e_cdiff/rendering/camera_options.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "metrics/session_metrics.h"
#include "nav_msgs/Odometry.h"
#include "node_graph/messages/ego_sensors.h"
#include "ros/ros.h"
#include "session/session_setup.h"
#include "tf2_msgs/TFMessage.h"
#include "tf2_ros/static_transform_broadcaster.h"
#include "tf2_ros/transform_broadcaster.h"

namespace cdiff::node_graph {

/// Pose in `map`, speed in the body frame; the covariances say that both are exact to 1 mm, 1 mrad,
/// 1 mm/s and 1 mrad/s, because filters take no zeros.
nav_msgs::Odometry toOdometryMsg(const traffic::Vehicle& vehicle, double time);
using Transforms = std::vector<geometry_msgs::TransformStamped>;
/// Transforms of ego and CBVs.
Transforms vehicleTransforms(const traffic::TrafficSnapshot& snapshot);
/// `map` -> "cbv_K/base_link" for a slot K, so that a view can follow whoever is in it: the pose of
/// its CBV, before there is one of the ego; nullopt without both.
std::optional<geometry_msgs::TransformStamped> slotTransform(
    const traffic::TrafficSnapshot& snapshot, int slot);
/// A vehicle's base_link -> camera (x along the view, z up) -> camera_optical (x right, y down, z
/// along the view); they never change.
Transforms cameraTransforms(const traffic::Vehicle& vehicle, double time,
                            const rendering::CameraRig& rig);
/// Frame of a camera: "<vehicle>/camera", of a camera C other than the front one
/// "<vehicle>/camera_C".
std::string cameraFrame(const std::string& vehicle_id, const std::string& camera);
/// Both, for a bag; without cameras where `rigs` is null.
tf2_msgs::TFMessage toTfMsg(const traffic::TrafficSnapshot& snapshot,
                            const session::VehicleRigs* rigs = nullptr);

/// What people and tools look at, besides the session's own messages: what an ego's sensors would
/// tell (EgoSensors), the odometry of CBVs, and the transforms of ego and CBVs, `map` ->
/// `<vehicle>/base_link` at every tick and, once a vehicle, those of its camera. Nothing of the
/// session is computed from it.
class Display {
 public:
  explicit Display(ros::NodeHandle& node) : node_(node) {}
  /// What the ego senses in a session, and odometry of its CBVs; `setup` must outlive this object.
  void showSensors(const session::SessionSetup& setup);
  /// From now on tf holds the camera frames too.
  void showCameras(const session::VehicleRigs& rigs) { rigs_ = rigs; }
  void publish(const traffic::TrafficSnapshot& snapshot);

 private:
  void publishOdometry(const traffic::TrafficSnapshot& snapshot);
  void mountCameras(const traffic::TrafficSnapshot& snapshot);

  ros::NodeHandle& node_;
  std::optional<EgoSensors> sensors_;
  std::vector<ros::Publisher> odometry_;  ///< of CBVs, by slot
  tf2_ros::TransformBroadcaster transforms_;
  tf2_ros::StaticTransformBroadcaster mounts_;
  std::optional<session::VehicleRigs> rigs_;
  std::set<std::pair<std::string, std::size_t>>
      mounted_;  ///< vehicles, with the index of their rig, whose camera frames are out
};

/// The session's metrics as messages: one report per decision; all measures in it once in a
/// simulated second and at the end.
class MetricReporter {
 public:
  /// Gives the measures of the session so far.
  using SessionSoFar = std::function<metrics::SessionMeasures()>;

  MetricReporter(const session::ScenarioOptions& options, SessionSoFar session_so_far);

  /// Call at every tick, in order, with the tick's measures; nullptr at ticks without a report.
  ::e2e_cdiff::MetricReport::ConstPtr report(const traffic::TrafficSnapshot& snapshot,
                                             const metrics::TickMeasures& measures);
  /// All measures as of the last report that held them.
  const metrics::SessionMeasures& session() const { return session_; }

 private:
  SessionSoFar session_so_far_;
  std::string protocol_;  ///< preset
  metrics::SessionMeasures session_;
  std::uint64_t decisions_per_report_;
  std::uint64_t decisions_ = 0;
};

// A session's measures so far as keys and values of /diagnostics.

/// The main measures, each "value unit (n = ...)" or "not defined: reason" under its label; then
/// under "not defined: REASON" the names of all measures that have no value for it.
std::vector<std::pair<std::string, std::string>> metricDiagnostics(
    const metrics::SessionMeasures& measures);

}  // namespace cdiff::node_graph
