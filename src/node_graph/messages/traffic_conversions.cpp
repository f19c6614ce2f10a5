// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/messages/traffic_conversions.h"

#include <cmath>

#include "e2e_cdiff/core/exceptions.h"
#include "node_graph/messages/perceived_conversions.h"
#include "ros/this_node.h"

namespace cdiff::node_graph {
namespace {

using traffic::SessionStatus;
using traffic::VehicleRole;

static_assert(static_cast<int>(VehicleRole::kEgo) == msgs::Vehicle::EGO);
static_assert(static_cast<int>(VehicleRole::kCbv) == msgs::Vehicle::CBV);
static_assert(static_cast<int>(VehicleRole::kBackground) == msgs::Vehicle::BACKGROUND);
static_assert(static_cast<int>(SessionStatus::kRunning) == msgs::TrafficSnapshot::RUNNING);
static_assert(static_cast<int>(SessionStatus::kCompleted) == msgs::TrafficSnapshot::COMPLETED);
static_assert(static_cast<int>(SessionStatus::kBlocked) == msgs::TrafficSnapshot::BLOCKED);
static_assert(static_cast<int>(SessionStatus::kDeviated) == msgs::TrafficSnapshot::DEVIATED);
static_assert(static_cast<int>(SessionStatus::kTimedOut) == msgs::TrafficSnapshot::TIMED_OUT);
static_assert(static_cast<int>(SessionStatus::kCollided) == msgs::TrafficSnapshot::COLLIDED);
static_assert(static_cast<int>(SessionStatus::kInterrupted) == msgs::TrafficSnapshot::INTERRUPTED);
static_assert(static_cast<int>(SessionStatus::kError) == msgs::TrafficSnapshot::ERROR);

msgs::Fault toMsg(const traffic::Fault& fault) {
  msgs::Fault message;
  message.tick = fault.tick;
  message.source = fault.source;
  message.text = fault.text;
  return message;
}

msgs::SteeringChange toMsg(const traffic::SteeringChange& change) {
  msgs::SteeringChange message;
  message.by = change.by;
  message.what = change.what;
  message.before = change.before;
  message.after = change.after;
  return message;
}

std_msgs::Header headerOf(const traffic::TrafficSnapshot& snapshot) {
  std_msgs::Header header;
  header.stamp = toStamp(snapshot.time);
  header.frame_id = frameId(kMapFrame);
  return header;
}

}  // namespace

std::string frameId(const std::string& frame) {
  const std::string& space = ros::this_node::getNamespace();
  return space.size() < 2 ? frame : space.substr(1) + "/" + frame;
}

ros::Time toStamp(double seconds) { return ros::Time(seconds); }

std::uint64_t nearestTick(const ros::Time& stamp, double simulation_step) {
  return static_cast<std::uint64_t>(std::llround(stamp.toSec() / simulation_step));
}

msgs::VehicleState toMsg(const traffic::VehicleState& state) {
  msgs::VehicleState message;
  message.x = state.position.x();
  message.y = state.position.y();
  message.z = state.elevation;
  message.heading = state.heading;
  message.speed = state.speed;
  return message;
}

traffic::VehicleState fromMsg(const msgs::VehicleState& message) {
  return {{message.x, message.y}, message.z, message.heading, message.speed};
}

msgs::Vehicle toMsg(const traffic::Vehicle& vehicle) {
  msgs::Vehicle message;
  message.id = vehicle.id;
  message.role = static_cast<std::uint8_t>(vehicle.role);
  message.cbv_slot = vehicle.cbv_slot;
  message.state = toMsg(vehicle.state);
  message.length = vehicle.dimensions.length;
  message.width = vehicle.dimensions.width;
  message.height = vehicle.dimensions.height;
  message.acceleration = vehicle.acceleration;
  message.yaw_rate = vehicle.yaw_rate;
  message.driven = vehicle.applied_action.has_value();
  if (vehicle.applied_action) {
    message.throttle = vehicle.applied_action->throttle;
    message.steer = vehicle.applied_action->steer;
    message.brake = vehicle.applied_action->brake;
  }
  message.lane_id = vehicle.lane_id;
  return message;
}

traffic::Vehicle fromMsg(const msgs::Vehicle& message) {
  if (message.role > msgs::Vehicle::BACKGROUND) {
    throw core::InputError("vehicle '" + message.id + "' has the unknown role " +
                           std::to_string(message.role));
  }
  traffic::Vehicle vehicle;
  vehicle.id = message.id;
  vehicle.role = static_cast<VehicleRole>(message.role);
  vehicle.cbv_slot = message.cbv_slot;
  vehicle.state = fromMsg(message.state);
  vehicle.dimensions = {message.length, message.width, message.height};
  vehicle.acceleration = message.acceleration;
  vehicle.yaw_rate = message.yaw_rate;
  if (message.driven)
    vehicle.applied_action = traffic::ControlAction{message.throttle, message.steer, message.brake};
  vehicle.lane_id = message.lane_id;
  return vehicle;
}

msgs::TrafficSnapshot toMsg(const traffic::TrafficSnapshot& snapshot) {
  msgs::TrafficSnapshot message;
  message.header = headerOf(snapshot);
  message.tick = snapshot.tick;
  message.time = snapshot.time;
  message.decision_tick = snapshot.decision_tick;
  message.status = static_cast<std::uint8_t>(snapshot.status);
  message.vehicles.reserve(snapshot.vehicles.size());
  for (const traffic::Vehicle& vehicle : snapshot.vehicles)
    message.vehicles.push_back(toMsg(vehicle));
  for (const traffic::SignalState& signal : snapshot.signals) {
    message.signals.emplace_back();
    message.signals.back().id = signal.id;
    message.signals.back().state = signal.state;
  }
  for (const traffic::Contact& contact : snapshot.contacts) {
    message.contacts.emplace_back();
    message.contacts.back().first = contact.first;
    message.contacts.back().second = contact.second;
  }
  message.removed = snapshot.removed;
  for (const traffic::Fault& fault : snapshot.faults) message.faults.push_back(toMsg(fault));
  for (const traffic::SteeringChange& change : snapshot.steering)
    message.steering.push_back(toMsg(change));
  return message;
}

traffic::TrafficSnapshot fromMsg(const msgs::TrafficSnapshot& message) {
  if (message.status > msgs::TrafficSnapshot::ERROR) {
    throw core::InputError("snapshot " + std::to_string(message.tick) + " has the unknown status " +
                           std::to_string(message.status));
  }
  traffic::TrafficSnapshot snapshot;
  snapshot.tick = message.tick;
  snapshot.time = message.time;
  snapshot.decision_tick = message.decision_tick != 0;
  snapshot.status = static_cast<SessionStatus>(message.status);
  snapshot.vehicles.reserve(message.vehicles.size());
  for (const msgs::Vehicle& vehicle : message.vehicles)
    snapshot.vehicles.push_back(fromMsg(vehicle));
  for (const msgs::SignalState& signal : message.signals)
    snapshot.signals.push_back({signal.id, signal.state});
  for (const msgs::Contact& contact : message.contacts)
    snapshot.contacts.push_back({contact.first, contact.second});
  snapshot.removed = message.removed;
  for (const msgs::Fault& fault : message.faults)
    snapshot.faults.push_back({fault.tick, fault.source, fault.text});
  snapshot.steering = fromMsg(message.steering);
  return snapshot;
}

std::vector<traffic::SteeringChange> fromMsg(const std::vector<msgs::SteeringChange>& changes) {
  std::vector<traffic::SteeringChange> steering;
  for (const msgs::SteeringChange& change : changes)
    steering.push_back({change.by, change.what, change.before, change.after});
  return steering;
}

msgs::ControlAction toMsg(const planning::PlannedAction& action,
                          const traffic::TrafficSnapshot& snapshot, const ActionOrigin& origin) {
  msgs::ControlAction message;
  message.header = headerOf(snapshot);
  message.tick = snapshot.tick;
  message.slot = action.slot;
  message.vehicle_id = action.vehicle_id;
  message.throttle = action.action.throttle;
  message.steer = action.action.steer;
  message.brake = action.action.brake;
  message.planner = origin.planner;
  message.planner_latency_ms = origin.latency_ms;
  message.fault = origin.fault.empty() ? action.fault : origin.fault;
  for (const planning::AttendedVehicle& vehicle : action.attended) {
    message.attended.emplace_back();
    message.attended.back().vehicle_id = vehicle.vehicle_id;
    message.attended.back().weight = vehicle.weight;
  }
  message.perception = toMsg(action.perception);
  return message;
}

planning::PlannedAction fromMsg(const msgs::ControlAction& message) {
  planning::PlannedAction action;
  action.slot = message.slot;
  action.vehicle_id = message.vehicle_id;
  action.action = {message.throttle, message.steer, message.brake};
  action.fault = message.fault;
  for (const msgs::AttendedVehicle& vehicle : message.attended)
    action.attended.push_back({vehicle.vehicle_id, vehicle.weight});
  action.perception = fromMsg(message.perception);
  return action;
}

msgs::Rollout toRolloutMsg(const planning::PlannedAction& action,
                           const traffic::TrafficSnapshot& snapshot) {
  msgs::Rollout message;
  message.header = headerOf(snapshot);
  message.tick = snapshot.tick;
  message.slot = action.slot;
  message.vehicle_id = action.vehicle_id;
  for (const planning::RolloutPoint& point : action.rollout) {
    message.points.emplace_back();
    message.points.back().state = toMsg(point.state);
    message.points.back().throttle = point.action.throttle;
    message.points.back().steer = point.action.steer;
    message.points.back().brake = point.action.brake;
  }
  for (const planning::PlannedCandidate& candidate : action.candidates) {
    message.candidates.emplace_back();
    message.candidates.back().score = candidate.score;
    message.candidates.back().chosen = candidate.chosen ? 1 : 0;
    for (const Eigen::Vector2d& place : candidate.places) {
      message.candidates.back().x.push_back(place.x());
      message.candidates.back().y.push_back(place.y());
    }
  }
  return message;
}

std::vector<planning::RolloutPoint> fromMsg(const msgs::Rollout& message) {
  std::vector<planning::RolloutPoint> points;
  for (const msgs::RolloutPoint& point : message.points) {
    points.push_back({fromMsg(point.state), {point.throttle, point.steer, point.brake}});
  }
  return points;
}

std::vector<planning::PlannedCandidate> candidatesFromMsg(const msgs::Rollout& message) {
  std::vector<planning::PlannedCandidate> candidates;
  for (const msgs::PlannedCandidate& from : message.candidates) {
    planning::PlannedCandidate& candidate = candidates.emplace_back();
    candidate.score = from.score;
    candidate.chosen = from.chosen != 0;
    for (std::size_t i = 0; i < std::min(from.x.size(), from.y.size()); ++i)
      candidate.places.emplace_back(from.x[i], from.y[i]);
  }
  return candidates;
}

}  // namespace cdiff::node_graph
