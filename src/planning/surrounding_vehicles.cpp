// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planning/surrounding_vehicles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::planning {
namespace {

struct Neighbor {
  double distance = 0.0;  ///< of the centers [m]
  const traffic::Vehicle* vehicle = nullptr;
};

/// Nearest first, equal distances by id.
std::vector<Neighbor> neighborsOf(const traffic::TrafficSnapshot& snapshot,
                                  const traffic::Vehicle& vehicle, double radius) {
  std::vector<Neighbor> found;
  for (const traffic::Vehicle& other : snapshot.vehicles) {
    if (other.id == vehicle.id || !isFinite(other.state)) continue;
    if (traffic::onDifferentLevels(other, vehicle)) continue;
    const double distance = (other.state.position - vehicle.state.position).norm();
    if (distance < radius) found.push_back({distance, &other});
  }
  std::sort(found.begin(), found.end(), [](const Neighbor& a, const Neighbor& b) {
    return std::tie(a.distance, a.vehicle->id) < std::tie(b.distance, b.vehicle->id);
  });
  return found;
}

constexpr double kSubstep = 0.05;                    // [s]
constexpr double kThrottleAcceleration = 0.5633837;  // published fit of other vehicles [m/s^2]
constexpr double kBrakeAcceleration = -4.952399;     // [m/s^2]
constexpr double kMaxAcceleration = 3.0;             // of SUMO's cars [m/s^2]

using States = std::vector<traffic::VehicleState>;

States holdAction(const traffic::Vehicle& vehicle, const dynamics::BicycleModelOptions& bicycle,
                  std::size_t steps) {
  const traffic::ControlAction& action = *vehicle.applied_action;
  const double wheelbase = bicycle.rear_length + bicycle.front_length;
  const double slip =
      std::atan(bicycle.rear_length / wheelbase * std::tan(bicycle.steering_gain * action.steer));
  const double acceleration = kThrottleAcceleration * action.throttle * (1.0 - action.brake) +
                              kBrakeAcceleration * action.brake;
  States states;
  traffic::VehicleState state = vehicle.state;
  for (std::size_t i = 0; i < 2 * steps; ++i) {
    state.position += state.speed * kSubstep * geometry::direction(state.heading + slip);
    state.heading = core::wrapAngle(state.heading +
                                    state.speed / bicycle.rear_length * std::sin(slip) * kSubstep);
    state.speed = std::max(0.0, state.speed + acceleration * kSubstep);
    if (i % 2 == 1) states.push_back(state);
  }
  return states;
}

double heldAcceleration(const traffic::Vehicle& vehicle) {
  return std::clamp(vehicle.acceleration, kBrakeAcceleration, kMaxAcceleration);
}

States holdYawRate(const traffic::Vehicle& vehicle, std::size_t steps) {
  States states;
  traffic::VehicleState state = vehicle.state;
  const double acceleration = heldAcceleration(vehicle);
  for (std::size_t i = 0; i < steps; ++i) {
    const bool moves = state.speed > 0.0;
    const double turn = moves ? vehicle.yaw_rate * kForecastStep : 0.0;
    state.position += state.speed * kForecastStep * geometry::direction(state.heading + 0.5 * turn);
    state.heading = core::wrapAngle(state.heading + turn);
    state.speed = std::max(0.0, state.speed + acceleration * kForecastStep);
    states.push_back(state);
  }
  return states;
}

/// A place on a lane that moves along the lanes; before and after them straight on.
class LaneWalk {
 public:
  /// nullopt when the vehicle does not drive along its lane.
  static std::optional<LaneWalk> find(const map::RoadNetwork& network,
                                      const traffic::VehicleState& state,
                                      const std::string& lane_id) {
    constexpr double kMaxOffset = 2.5;
    const double max_angle = core::degreesToRadians(60.0);
    const map::LaneIndex lane = lane_id.empty() ? map::kNoLane : network.findLane(lane_id);
    if (lane == map::kNoLane) return std::nullopt;
    LaneWalk walk(network, lane);
    const geometry::Polyline& line = walk.line();
    const double nearest = line.project(state.position).arc_length;
    const double heading = line.headingAt(nearest);
    const Eigen::Vector2d forward = geometry::direction(heading);
    const Eigen::Vector2d away = state.position - line.positionAt(nearest);
    // Beyond the ends of the lane the center may lie ahead or behind by half a vehicle.
    walk.arc_length_ = nearest + forward.dot(away);
    walk.offset_ = geometry::cross(forward, away);
    const double angle = core::angleDifference(state.heading, heading);
    if (std::abs(walk.offset_) > kMaxOffset || std::abs(angle) > max_angle) return std::nullopt;
    return walk;
  }

  void advance(double distance) {
    arc_length_ += distance;
    while (arc_length_ > line().length()) {
      const map::LaneIndex next = following();
      if (next == map::kNoLane) return;
      arc_length_ -= line().length();
      lane_ = next;
    }
  }

  void place(traffic::VehicleState& state) const {
    const double inside = std::clamp(arc_length_, 0.0, line().length());
    const double heading = line().headingAt(inside);
    const Eigen::Vector2d forward = geometry::direction(heading);
    const Eigen::Vector3d point = line().pointAt(inside);
    state.position = point.head<2>() + (arc_length_ - inside) * forward +
                     offset_ * geometry::leftNormal(forward);
    state.heading = heading;
    state.elevation = point.z();
  }

  double speedLimit() const { return network_->lane(lane_).speed_limit; }

 private:
  LaneWalk(const map::RoadNetwork& network, map::LaneIndex lane)
      : network_(&network), lane_(lane) {}

  const geometry::Polyline& line() const { return network_->lane(lane_).centerline; }

  map::LaneIndex following() const {
    const std::vector<map::LaneLink>& links = network_->lane(lane_).next;
    if (links.size() == 1) return links.front().to;
    for (const map::LaneLink& link : links) {
      if (link.direction == 's') return link.to;
    }
    return map::kNoLane;
  }

  const map::RoadNetwork* network_;
  map::LaneIndex lane_;
  double arc_length_ = 0.0;
  double offset_ = 0.0;
};

States followLane(const traffic::Vehicle& vehicle, LaneWalk walk, std::size_t steps) {
  States states;
  traffic::VehicleState state = vehicle.state;
  const double acceleration = heldAcceleration(vehicle);
  const double top_speed = std::max(state.speed, walk.speedLimit());
  for (std::size_t i = 0; i < steps; ++i) {
    if (state.speed > 0.0) {
      walk.advance(state.speed * kForecastStep);
      walk.place(state);
    }
    state.speed = std::clamp(state.speed + acceleration * kForecastStep, 0.0, top_speed);
    states.push_back(state);
  }
  return states;
}

}  // namespace

bool isFinite(const traffic::VehicleState& state) {
  return state.position.allFinite() && std::isfinite(state.elevation) &&
         std::isfinite(state.heading) && std::isfinite(state.speed);
}

std::string faultOf(const PlanningTask& task) {
  if (!isFinite(task.vehicle->state)) return "its state is not finite";
  return task.route == nullptr || task.route->empty() ? "it has no route" : "";
}

std::string faultOf(const traffic::TrafficSnapshot& snapshot, const PlanningTask& task) {
  const std::string own = faultOf(task);
  if (!own.empty()) return own;
  for (const traffic::Vehicle& other : snapshot.vehicles) {
    if (!isFinite(other.state)) return "the state of '" + other.id + "' is not finite";
  }
  return "";
}

const traffic::Vehicle* nearestVehicle(const traffic::TrafficSnapshot& snapshot,
                                       const traffic::Vehicle& vehicle) {
  const auto found = neighborsOf(snapshot, vehicle, std::numeric_limits<double>::infinity());
  return found.empty() ? nullptr : found.front().vehicle;
}

std::vector<const traffic::Vehicle*> vehiclesAround(const traffic::TrafficSnapshot& snapshot,
                                                    const traffic::Vehicle& vehicle,
                                                    const traffic::Vehicle* other) {
  constexpr double kRadius = 50.0;  // [m]: two vehicles at 8 m/s close 51 m in 3.2 s
  constexpr std::size_t kMost = 8;
  std::vector<const traffic::Vehicle*> around;
  for (const Neighbor& neighbor : neighborsOf(snapshot, vehicle, kRadius)) {
    if (neighbor.vehicle != other && around.size() < kMost) around.push_back(neighbor.vehicle);
  }
  return around;
}

std::vector<traffic::VehicleState> forecastMotion(const traffic::Vehicle& vehicle,
                                                  const map::RoadNetwork& network,
                                                  const dynamics::BicycleModelOptions& bicycle,
                                                  std::size_t steps) {
  if (vehicle.applied_action) return holdAction(vehicle, bicycle, steps);
  const auto walk = LaneWalk::find(network, vehicle.state, vehicle.lane_id);
  return walk ? followLane(vehicle, *walk, steps) : holdYawRate(vehicle, steps);
}

std::vector<traffic::VehicleState> forecastAlongRoute(const traffic::Vehicle& vehicle,
                                                      const map::Route& route, double arc_length,
                                                      std::size_t steps) {
  constexpr double kHeldAcceleration = 1.0;  // [s]
  const auto normal = [&](double s) {
    const double heading = route.path().headingAt(std::clamp(s, 0.0, route.length()));
    return geometry::direction(heading + 0.5 * core::kPi);
  };
  const double offset =
      normal(arc_length)
          .dot(vehicle.state.position - route.path().extendedPoseAt(arc_length).position);
  std::vector<traffic::VehicleState> states;
  traffic::VehicleState state = vehicle.state;
  for (std::size_t i = 1; i <= steps; ++i) {
    const double time = static_cast<double>(i) * traffic::kRolloutStep;
    const double held = std::min(time, kHeldAcceleration);
    state.speed = std::max(0.0, vehicle.state.speed + held * vehicle.acceleration);
    arc_length += state.speed * traffic::kRolloutStep;
    state.position = route.path().extendedPoseAt(arc_length).position + offset * normal(arc_length);
    state.heading = route.path().headingAt(std::clamp(arc_length, 0.0, route.length()));
    states.push_back(state);
  }
  return states;
}

}  // namespace cdiff::planning
