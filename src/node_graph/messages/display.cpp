// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/messages/display.h"

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cmath>
#include <map>

#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "metrics/metric_registry.h"
#include "node_graph/messages/channel_conversions.h"
#include "node_graph/messages/session_conversions.h"
#include "node_graph/messages/topics.h"
#include "node_graph/messages/traffic_conversions.h"
#include "record/session_text.h"

namespace cdiff::node_graph {
namespace {

geometry_msgs::Quaternion toQuaternion(double heading) {
  geometry_msgs::Quaternion quaternion;
  quaternion.z = std::sin(0.5 * heading);
  quaternion.w = std::cos(0.5 * heading);
  return quaternion;
}

std::string frameOf(const traffic::Vehicle& vehicle) { return frameId(vehicle.id + "/base_link"); }

geometry_msgs::TransformStamped transformBetween(const std::string& parent,
                                                 const std::string& child, double time) {
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = toStamp(time);
  transform.header.frame_id = parent;
  transform.child_frame_id = child;
  return transform;
}

/// Where a camera sits: base_link lies on the road below the box's center. Turned about z (up) by
/// its yaw, then about y (left) by its pitch.
geometry_msgs::TransformStamped mount(const traffic::Vehicle& vehicle, double time,
                                      const rendering::RigCamera& camera) {
  auto transform = transformBetween(frameOf(vehicle), cameraFrame(vehicle.id, camera.name), time);
  transform.transform.translation.x = camera.x;
  transform.transform.translation.y = camera.y;
  transform.transform.translation.z = camera.z;
  const double half_pitch = 0.5 * core::degreesToRadians(camera.pitch);
  const double half_yaw = 0.5 * core::degreesToRadians(camera.yaw);
  transform.transform.rotation.x = 0.0 - std::sin(half_yaw) * std::sin(half_pitch);
  transform.transform.rotation.y = std::cos(half_yaw) * std::sin(half_pitch);
  transform.transform.rotation.z = std::sin(half_yaw) * std::cos(half_pitch);
  transform.transform.rotation.w = std::cos(half_yaw) * std::cos(half_pitch);
  return transform;
}

/// REP 103: x right, y down, z forward.
geometry_msgs::TransformStamped optical(const traffic::Vehicle& vehicle, double time,
                                        const std::string& camera) {
  auto transform =
      transformBetween(cameraFrame(vehicle.id, camera), opticalFrame(vehicle.id, camera), time);
  transform.transform.rotation.x = -0.5;
  transform.transform.rotation.y = 0.5;
  transform.transform.rotation.z = -0.5;
  transform.transform.rotation.w = 0.5;
  return transform;
}

}  // namespace

nav_msgs::Odometry toOdometryMsg(const traffic::Vehicle& vehicle, double time) {
  nav_msgs::Odometry message;
  message.header.stamp = toStamp(time);
  message.header.frame_id = frameId(kMapFrame);
  message.child_frame_id = frameOf(vehicle);
  message.pose.pose.position.x = vehicle.state.position.x();
  message.pose.pose.position.y = vehicle.state.position.y();
  message.pose.pose.position.z = vehicle.state.elevation;
  message.pose.pose.orientation = toQuaternion(vehicle.state.heading);
  message.twist.twist.linear.x = vehicle.state.speed;
  message.twist.twist.angular.z = vehicle.yaw_rate;
  constexpr double kVariance = 1e-6;  // of 1 mm, 1 mrad, 1 mm/s, 1 mrad/s
  constexpr std::size_t kNextOnDiagonal = 7;
  for (std::size_t i = 0; i < message.pose.covariance.size(); i += kNextOnDiagonal)
    message.pose.covariance[i] = message.twist.covariance[i] = kVariance;
  return message;
}

namespace {

geometry_msgs::TransformStamped transformOf(const traffic::Vehicle& vehicle, double time) {
  auto transform = transformBetween(frameId(kMapFrame), frameOf(vehicle), time);
  transform.transform.translation.x = vehicle.state.position.x();
  transform.transform.translation.y = vehicle.state.position.y();
  transform.transform.translation.z = vehicle.state.elevation;
  transform.transform.rotation = toQuaternion(vehicle.state.heading);
  return transform;
}

}  // namespace

Transforms vehicleTransforms(const traffic::TrafficSnapshot& snapshot) {
  Transforms transforms;
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
    if (vehicle.role == traffic::VehicleRole::kBackground) continue;
    transforms.push_back(transformOf(vehicle, snapshot.time));
  }
  return transforms;
}

std::string cameraFrame(const std::string& vehicle_id, const std::string& camera) {
  const std::string suffix = camera == rendering::kFrontCamera ? "" : "_" + camera;
  return frameId(vehicle_id + "/camera" + suffix);
}

Transforms cameraTransforms(const traffic::Vehicle& vehicle, double time,
                            const rendering::CameraRig& rig) {
  Transforms transforms;
  for (const rendering::RigCamera& camera : rig.cameras) {
    transforms.push_back(mount(vehicle, time, camera));
    transforms.push_back(optical(vehicle, time, camera.name));
  }
  return transforms;
}

namespace {

int slotOf(const traffic::Vehicle& vehicle) {
  return vehicle.role == traffic::VehicleRole::kEgo ? kEgoSlot : vehicle.cbv_slot;
}

}  // namespace

std::optional<geometry_msgs::TransformStamped> slotTransform(
    const traffic::TrafficSnapshot& snapshot, int slot) {
  const traffic::Vehicle* cbv = snapshot.cbv(slot);
  if (cbv == nullptr) cbv = snapshot.ego();
  if (cbv == nullptr) return std::nullopt;
  auto transform = transformOf(*cbv, snapshot.time);
  transform.child_frame_id = frameId("cbv_" + std::to_string(slot) + "/base_link");
  return transform;
}

tf2_msgs::TFMessage toTfMsg(const traffic::TrafficSnapshot& snapshot,
                            const session::VehicleRigs* rigs) {
  tf2_msgs::TFMessage message;
  message.transforms = vehicleTransforms(snapshot);
  if (rigs == nullptr) return message;
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
    if (vehicle.role == traffic::VehicleRole::kBackground) continue;
    for (auto& transform : cameraTransforms(vehicle, snapshot.time, rigs->of(slotOf(vehicle))))
      message.transforms.push_back(std::move(transform));
  }
  return message;
}

void Display::showSensors(const session::SessionSetup& setup) {
  constexpr std::uint32_t kQueueSize = 100;
  sensors_.emplace(node_, setup);
  for (int slot = 0; slot < setup.options().max_cbv; ++slot)
    odometry_.push_back(node_.advertise<nav_msgs::Odometry>(
        Topic(ChannelId::kCbvOdometry, slot).name(), kQueueSize));
  mounts_.sendTransform(laserMount(traffic::kEgoId, setup.options().ego.laser.height, 0.0));
}

void Display::publish(const traffic::TrafficSnapshot& snapshot) {
  if (sensors_) sensors_->publish(snapshot);
  publishOdometry(snapshot);
  if (rigs_) mountCameras(snapshot);
  Transforms transforms = vehicleTransforms(snapshot);
  for (int slot = 0; slot < static_cast<int>(odometry_.size()); ++slot) {
    if (const auto followed = slotTransform(snapshot, slot)) transforms.push_back(*followed);
  }
  transforms_.sendTransform(transforms);
}

void Display::publishOdometry(const traffic::TrafficSnapshot& snapshot) {
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
    if (vehicle.role != traffic::VehicleRole::kCbv) continue;
    const ros::Publisher& publisher = odometry_.at(static_cast<std::size_t>(vehicle.cbv_slot));
    if (publisher.getNumSubscribers() > 0) publisher.publish(toOdometryMsg(vehicle, snapshot.time));
  }
}

void Display::mountCameras(const traffic::TrafficSnapshot& snapshot) {
  Transforms added;
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
    if (vehicle.role == traffic::VehicleRole::kBackground) continue;
    const int slot = slotOf(vehicle);
    if (!mounted_.emplace(vehicle.id, rigs_->indexOf(slot)).second) continue;
    for (auto& transform : cameraTransforms(vehicle, snapshot.time, rigs_->of(slot)))
      added.push_back(std::move(transform));
  }
  if (!added.empty()) mounts_.sendTransform(added);
}

namespace {

/// Measures of the whole session go out once in a simulated second.
std::uint64_t decisionsPerReport(const session::ScenarioOptions& options) {
  const double decisions = 1.0 / options.decision_period;
  return static_cast<std::uint64_t>(std::max(1L, std::lround(decisions)));
}

}  // namespace

MetricReporter::MetricReporter(const session::ScenarioOptions& options, SessionSoFar session_so_far)
    : session_so_far_(std::move(session_so_far)),
      protocol_(options.protocol.preset),
      decisions_per_report_(decisionsPerReport(options)) {}

msgs::MetricReport::ConstPtr MetricReporter::report(const traffic::TrafficSnapshot& snapshot,
                                                    const metrics::TickMeasures& measures) {
  const bool final = snapshot.status != traffic::SessionStatus::kRunning;
  if (!snapshot.decision_tick && !final) return nullptr;
  msgs::MetricReport report = toMsg(measures, snapshot);
  report.protocol = protocol_;
  const bool due = snapshot.decision_tick && decisions_++ % decisions_per_report_ == 0;
  if (due || final) {
    session_ = session_so_far_();
    report.measures = toMsg(session_);
  }
  return boost::make_shared<const msgs::MetricReport>(report);
}

namespace {

std::string valueText(const metrics::MeasureDefinition& definition,
                      const metrics::Measure& measure) {
  if (measure.unit == "count" && measure.value) return core::formatNumber(*measure.value);
  return record::measureText(measure, definition.decimals);
}

}  // namespace

std::vector<std::pair<std::string, std::string>> metricDiagnostics(
    const metrics::SessionMeasures& measures) {
  std::vector<std::pair<std::string, std::string>> values;
  std::map<std::string, std::vector<std::string>> undefined;
  for (const metrics::MeasureDefinition& definition : metrics::measureDefinitions()) {
    const metrics::Measure measure = measures.at(definition);
    if (definition.main) values.emplace_back(definition.label, valueText(definition, measure));
    if (!measure.value) undefined[measure.reason].emplace_back(definition.name);
  }
  for (const auto& [reason, names] : undefined)
    values.emplace_back("not defined: " + reason, core::joinText(names, ", "));
  return values;
}

}  // namespace cdiff::node_graph
