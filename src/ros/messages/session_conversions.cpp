// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <cmath>
#include <limits>

#include "core/file.h"
#include "e2e_cdiff/core/options.h"
#include "metrics/metric_registry.h"
#include "ros/messages/conversions.h"

namespace cdiff::ros {
namespace {

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

msgs::Measure toMsg(const std::string& name, const metrics::Measure& measure) {
  msgs::Measure message;
  message.name = name;
  message.defined = measure.value.has_value();
  message.value = measure.value.value_or(kUndefined);
  message.n = measure.n;
  message.unit = measure.unit;
  message.reason = measure.reason;
  message.target = measure.target;
  return message;
}

}  // namespace

msgs::SessionInfo toMsg(const session::SessionSetup& setup) {
  msgs::SessionInfo message;
  message.header.frame_id = kMapFrame;
  message.scenario_yaml = core::dumpOptions(setup.options());
  message.seed = setup.options().seed;
  message.network_text = setup.import().text;
  message.network_file = setup.import().file.string();
  message.network_source = setup.import().source.string();
  message.network_source_sha256 = setup.import().source_sha256;
  message.network_text_sha256 = core::sha256(setup.import().text);
  message.network_changes = setup.import().changes;
  for (const Eigen::Vector3d& point : setup.egoRoute().path().points()) {
    message.ego_route.emplace_back();
    message.ego_route.back().x = point.x();
    message.ego_route.back().y = point.y();
    message.ego_route.back().z = point.z();
  }
  return message;
}

session::ScenarioOptions optionsFromMsg(const msgs::SessionInfo& message) {
  session::ScenarioOptions options;
  core::loadOptions({"scenario of the session", message.scenario_yaml}, options);
  return options;
}

map::ImportedNetwork importFromMsg(const msgs::SessionInfo& message) {
  map::ImportedNetwork import;
  import.file = message.network_file;
  import.source = message.network_source;
  import.source_sha256 = message.network_source_sha256;
  import.text = message.network_text;
  import.changes = message.network_changes;
  return import;
}

std::vector<Eigen::Vector3d> routeFromMsg(const msgs::SessionInfo& message) {
  std::vector<Eigen::Vector3d> points;
  for (const geometry_msgs::Point& point : message.ego_route)
    points.emplace_back(point.x, point.y, point.z);
  return points;
}

nav_msgs::Path toPathMsg(const map::Route& route) {
  nav_msgs::Path message;
  message.header.frame_id = kMapFrame;
  const geometry::Polyline& path = route.path();
  for (std::size_t i = 0; i < path.points().size(); ++i) {
    geometry_msgs::PoseStamped pose;
    pose.header.frame_id = kMapFrame;
    pose.pose.position.x = path.points()[i].x();
    pose.pose.position.y = path.points()[i].y();
    pose.pose.position.z = path.points()[i].z();
    const double heading = path.headingAt(path.arcLengths()[i]);
    pose.pose.orientation.z = std::sin(0.5 * heading);
    pose.pose.orientation.w = std::cos(0.5 * heading);
    message.poses.push_back(pose);
  }
  return message;
}

std::vector<Eigen::Vector3d> fromMsg(const nav_msgs::Path& message) {
  std::vector<Eigen::Vector3d> points;
  for (const geometry_msgs::PoseStamped& pose : message.poses) {
    points.emplace_back(pose.pose.position.x, pose.pose.position.y, pose.pose.position.z);
  }
  return points;
}

msgs::MetricReport toMsg(const metrics::TickMeasures& measures,
                         const traffic::TrafficSnapshot& snapshot) {
  msgs::MetricReport message;
  message.header.stamp = toStamp(snapshot.time);
  message.header.frame_id = kMapFrame;
  message.tick = snapshot.tick;
  message.ttc_2d = measures.ttc_2d.value_or(kUndefined);
  message.nearest_distance = measures.nearest_distance.value_or(kUndefined);
  message.route_completion_percent = measures.route_completion_percent;
  message.ego_speed = measures.ego_speed;
  message.ego_off_road = measures.ego_off_road;
  message.cbv_off_road = static_cast<std::uint32_t>(measures.cbv_off_road);
  message.final = snapshot.status != traffic::SessionStatus::kRunning;
  return message;
}

std::vector<msgs::Measure> toMsg(const metrics::SessionMeasures& measures) {
  std::vector<msgs::Measure> all;
  for (const metrics::MeasureDefinition& definition : metrics::measureDefinitions())
    all.push_back(toMsg(definition.name, measures.at(definition)));
  return all;
}

}  // namespace cdiff::ros
