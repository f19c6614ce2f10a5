// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/messages/session_conversions.h"

#include <cmath>
#include <limits>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/options.h"
#include "metrics/metric_registry.h"
#include "node_graph/messages/traffic_conversions.h"

namespace cdiff::node_graph {
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
  message.header.frame_id = frameId(kMapFrame);
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
  message.header.frame_id = frameId(kMapFrame);
  const geometry::Polyline& path = route.path();
  for (std::size_t i = 0; i < path.points().size(); ++i) {
    geometry_msgs::PoseStamped pose;
    pose.header.frame_id = frameId(kMapFrame);
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
  message.header.frame_id = frameId(kMapFrame);
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

namespace {

msgs::ObjectiveReport toMsg(const guidance::ObjectiveReport& report) {
  msgs::ObjectiveReport message;
  message.name = report.name;
  message.weight = report.weight;
  message.value = report.value;
  message.gradient_norm = report.gradient_norm;
  message.capped_share = report.capped_share;
  message.dropped = report.dropped;
  return message;
}

void setChallenge(const guidance::ChallengeReport& report, msgs::VehicleGuidance& message) {
  message.challenge = report.state;
  message.challenge_reason = report.reason;
  message.challenge_delta = report.delta;
  if (report.last_brake_time) message.last_brake_time.push_back(*report.last_brake_time);
  if (report.ghost) message.ghost.push_back(node_graph::toMsg(*report.ghost));
  message.refusals = report.refusals;
}

guidance::ChallengeReport challengeOf(const msgs::VehicleGuidance& message) {
  guidance::ChallengeReport report;
  report.state = message.challenge;
  report.reason = message.challenge_reason;
  report.delta = message.challenge_delta;
  report.chosen = report.state.empty() ? 0 : message.chosen;
  if (!message.last_brake_time.empty()) report.last_brake_time = message.last_brake_time.front();
  if (!message.ghost.empty()) report.ghost = node_graph::fromMsg(message.ghost.front());
  report.refusals = message.refusals;
  return report;
}

msgs::VehicleGuidance toGuidanceMsg(const planning::PlannedAction& action) {
  msgs::VehicleGuidance message;
  message.slot = action.slot;
  message.vehicle_id = action.vehicle_id;
  for (const guidance::ObjectiveReport& report : action.guidance.objectives)
    message.objectives.push_back(toMsg(report));
  message.candidates = action.guidance.candidates;
  message.chosen = action.guidance.chosen;
  message.trust_region_share = action.guidance.trust_region_share;
  message.state_mismatch = action.state_mismatch;
  message.fault = action.fault;
  setChallenge(action.guidance.challenge, message);
  return message;
}

}  // namespace

msgs::GuidanceReport toGuidanceMsg(const std::vector<planning::PlannedAction>& actions,
                                   const traffic::TrafficSnapshot& snapshot) {
  msgs::GuidanceReport message;
  message.header.stamp = toStamp(snapshot.time);
  message.header.frame_id = frameId(kMapFrame);
  message.tick = snapshot.tick;
  for (const planning::PlannedAction& action : actions)
    message.vehicles.push_back(toGuidanceMsg(action));
  return message;
}

guidance::GuidanceReport fromMsg(const msgs::VehicleGuidance& message) {
  guidance::GuidanceReport report;
  for (const msgs::ObjectiveReport& objective : message.objectives) {
    report.objectives.push_back({objective.name, objective.weight, objective.value,
                                 objective.gradient_norm, objective.capped_share,
                                 objective.dropped});
  }
  report.candidates = message.candidates;
  report.chosen = message.chosen;
  report.trust_region_share = message.trust_region_share;
  report.challenge = challengeOf(message);
  return report;
}

namespace {

geometry_msgs::Point toMsg(const Eigen::Vector3d& point) {
  geometry_msgs::Point message;
  message.x = point.x();
  message.y = point.y();
  message.z = point.z();
  return message;
}

Eigen::Vector3d fromMsg(const geometry_msgs::Point& message) {
  return {message.x, message.y, message.z};
}

msgs::CbvAssignment toMsg(const cbv::CbvAssignment& assignment, const map::RoadNetwork& network) {
  msgs::CbvAssignment message;
  message.slot = assignment.slot;
  message.vehicle_id = assignment.vehicle_id;
  message.interaction_score = assignment.interaction_score;
  message.selected_tick = assignment.selected_tick;
  message.conflict_point = toMsg(assignment.conflict_point.position);
  message.ego_arc_length = assignment.conflict_point.ego_arc_length;
  message.ego_distance = assignment.conflict_point.ego_distance;
  message.cbv_distance = assignment.conflict_point.cbv_distance;
  message.ego_arrival = assignment.conflict_point.ego_arrival;
  message.cbv_arrival = assignment.conflict_point.cbv_arrival;
  if (assignment.conflict_aware_route.empty()) return message;
  for (const Eigen::Vector3d& point : assignment.conflict_aware_route.path().points()) {
    message.route_points.push_back(toMsg(point));
  }
  for (const map::LaneIndex lane : assignment.conflict_aware_route.lanes()) {
    message.route_lane_ids.push_back(network.lane(lane).id);
  }
  return message;
}

map::Route routeFromMsg(const msgs::CbvAssignment& message, const map::RoadNetwork& network) {
  if (message.route_points.empty()) return {};
  std::vector<Eigen::Vector3d> points;
  for (const geometry_msgs::Point& point : message.route_points) points.push_back(fromMsg(point));
  std::vector<map::LaneIndex> lanes;
  for (const std::string& id : message.route_lane_ids) {
    lanes.push_back(network.findLane(id));
    if (lanes.back() == map::kNoLane) {
      throw core::InputError("the route of CBV '" + message.vehicle_id + "' names lane '" + id +
                             "', which the network does not have");
    }
  }
  if (lanes.size() != points.size()) {
    throw core::InputError("the route of CBV '" + message.vehicle_id + "' has " +
                           std::to_string(points.size()) + " points, but " +
                           std::to_string(lanes.size()) + " lanes");
  }
  return map::Route(network, points, lanes);
}

cbv::CbvAssignment fromMsg(const msgs::CbvAssignment& message, const map::RoadNetwork& network) {
  cbv::CbvAssignment assignment;
  assignment.slot = message.slot;
  assignment.vehicle_id = message.vehicle_id;
  assignment.interaction_score = message.interaction_score;
  assignment.selected_tick = message.selected_tick;
  assignment.conflict_point = {fromMsg(message.conflict_point),
                               message.ego_arc_length,
                               message.ego_distance,
                               message.cbv_distance,
                               message.ego_arrival,
                               message.cbv_arrival};
  assignment.conflict_aware_route = routeFromMsg(message, network);
  return assignment;
}

}  // namespace

msgs::CbvSelection toMsg(const cbv::CbvSelection& selection, double time,
                         const map::RoadNetwork& network) {
  msgs::CbvSelection message;
  message.header.stamp = toStamp(time);
  message.header.frame_id = frameId(kMapFrame);
  message.tick = selection.tick;
  for (const cbv::CbvAssignment& assignment : selection.assignments) {
    message.assignments.push_back(toMsg(assignment, network));
  }
  for (const cbv::RejectedCandidate& candidate : selection.rejected) {
    message.rejected.emplace_back();
    message.rejected.back().vehicle_id = candidate.vehicle_id;
    message.rejected.back().reason = candidate.reason;
    message.rejected.back().interaction_score = candidate.interaction_score;
  }
  for (const cbv::ReleasedCbv& released : selection.released) {
    message.released.emplace_back();
    message.released.back().slot = released.slot;
    message.released.back().vehicle_id = released.vehicle_id;
    message.released.back().reason = released.reason;
  }
  return message;
}

cbv::CbvSelection fromMsg(const msgs::CbvSelection& message, const map::RoadNetwork& network) {
  cbv::CbvSelection selection;
  selection.tick = message.tick;
  for (const msgs::CbvAssignment& assignment : message.assignments) {
    selection.assignments.push_back(fromMsg(assignment, network));
  }
  for (const msgs::RejectedCandidate& candidate : message.rejected) {
    selection.rejected.push_back(
        {candidate.vehicle_id, candidate.reason, candidate.interaction_score});
  }
  for (const msgs::ReleasedCbv& released : message.released) {
    selection.released.push_back({released.slot, released.vehicle_id, released.reason});
  }
  return selection;
}

}  // namespace cdiff::node_graph
