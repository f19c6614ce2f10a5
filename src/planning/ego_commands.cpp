// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planning/ego_commands.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/dynamics/pedal_map.h"

namespace cdiff::planning {
namespace {

constexpr double kAngleRounding = 1e-4;  // [rad] of an angle that is the vehicle's largest

using core::formatNumber;
using core::InputError;

void requireFinite(double value, const char* name, const char* unit) {
  if (std::isfinite(value)) return;
  throw InputError(std::string(name) + " is " + formatNumber(value) + "; expected a number of " +
                   unit);
}

void requireForward(double speed, const char* name) {
  requireFinite(speed, name, "m/s");
  if (speed >= 0.0) return;
  throw InputError(std::string(name) + " is " + formatNumber(speed) +
                   " m/s; expected at least 0, the vehicle does not reverse");
}

void requireFinite(const AckermannCommand& command) {
  requireFinite(command.steering_angle, "steering_angle", "rad");
  requireFinite(command.steering_angle_velocity, "steering_angle_velocity", "rad/s");
  requireFinite(command.acceleration, "acceleration", "m/s^2");
  requireFinite(command.jerk, "jerk", "m/s^3");
  if (!command.by_acceleration) requireForward(command.speed, "speed");
}

/// `wanted`, or what is nearest to it within `rate` * `period` of `now`; a rate of 0 is no limit.
double limited(double wanted, double now, double rate, double period) {
  const double change = std::abs(rate) * period;
  return rate == 0.0 ? wanted : std::clamp(wanted, now - change, now + change);
}

/// Before the limit of the jerk [m/s^2].
double wantedAcceleration(const AckermannCommand& command, double speed, double period) {
  if (command.by_acceleration) return command.acceleration;
  const double wanted = (command.speed - speed) / period;
  const double most = std::abs(command.acceleration);
  return most == 0.0 ? wanted : std::clamp(wanted, -most, most);
}

/// Place at a time within the trajectory, from the ego's at `now` on.
Eigen::Vector2d placeAt(double time, const TimedPlace& now,
                        const std::vector<TimedPlace>& trajectory) {
  const auto after = std::find_if(trajectory.begin(), trajectory.end(),
                                  [&](const TimedPlace& place) { return place.time >= time; });
  const TimedPlace& next = after == trajectory.end() ? trajectory.back() : *after;
  const TimedPlace& last = after == trajectory.begin() ? now : *(after - 1);
  if (next.time <= last.time) return next.position;
  const double share = (time - last.time) / (next.time - last.time);
  return last.position + share * (next.position - last.position);
}

void requireAhead(double now, const std::vector<TimedPlace>& trajectory) {
  if (trajectory.empty()) throw InputError("the trajectory has no poses; expected some ahead");
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const TimedPlace& place = trajectory[i];
    const std::string name = "pose " + std::to_string(i) + " of the trajectory";
    if (!std::isfinite(place.time) || !place.position.allFinite())
      throw InputError(name + " is not finite; expected x and y in m in the frame map");
    if (i > 0 && place.time <= trajectory[i - 1].time) {
      throw InputError(name + " is " + core::formatFixed(trajectory[i - 1].time - place.time, 2) +
                       " s before the one before it; expected rising stamps");
    }
  }
  if (trajectory.back().time > now) return;
  throw InputError("the trajectory lies in the past: its last pose is " +
                   core::formatFixed(now - trajectory.back().time, 2) +
                   " s old; expected stamps of simulated time ahead");
}

}  // namespace

EgoCommands::EgoCommands(const dynamics::BicycleModelOptions& vehicle, double period)
    : model_(vehicle), period_(period) {}

traffic::ControlAction EgoCommands::pedals(const traffic::Vehicle& ego, double acceleration) const {
  return dynamics::pedalsFor(model_, ego.state.speed, acceleration);
}

traffic::ControlAction EgoCommands::follow(const traffic::Vehicle& ego,
                                           const AckermannCommand& command) const {
  requireFinite(command);
  const double largest = model_.options().steering_gain;
  if (std::abs(command.steering_angle) > largest + kAngleRounding) {
    throw InputError("steering_angle is " + formatNumber(command.steering_angle) +
                     " rad; the vehicle's largest is " + formatNumber(largest) +
                     " rad (vehicle.steering_gain)");
  }
  const double steered = ego.applied_action ? ego.applied_action->steer * largest : 0.0;
  double acceleration = wantedAcceleration(command, ego.state.speed, period_);
  acceleration = limited(acceleration, ego.acceleration, command.jerk, period_);
  traffic::ControlAction action = pedals(ego, acceleration);
  const double angle =
      limited(command.steering_angle, steered, command.steering_angle_velocity, period_);
  action.steer = std::clamp(angle / largest, -1.0, 1.0);
  return action;
}

traffic::ControlAction EgoCommands::follow(const traffic::Vehicle& ego,
                                           const VelocityCommand& command) const {
  constexpr double kStanding = 0.01;  // [m/s]
  requireForward(command.speed, "linear.x");
  requireFinite(command.yaw_rate, "angular.z", "rad/s");
  if (command.speed < kStanding) return traffic::ControlAction::failSafe();
  const double curvature = command.yaw_rate / command.speed;
  const double largest = dynamics::largestCurvature(model_);
  if (std::abs(curvature) > largest * (1.0 + 1e-6)) {
    throw InputError("angular.z " + formatNumber(command.yaw_rate) + " rad/s at linear.x " +
                     formatNumber(command.speed) + " m/s is a turn of " +
                     core::formatFixed(1.0 / std::abs(curvature), 2) +
                     " m; the vehicle's smallest is " + core::formatFixed(1.0 / largest, 2) + " m");
  }
  traffic::ControlAction action = pedals(ego, (command.speed - ego.state.speed) / period_);
  action.steer = dynamics::steerFor(model_, std::clamp(curvature, -largest, largest));
  return action;
}

traffic::ControlAction EgoCommands::follow(const traffic::Vehicle& ego, double now,
                                           const std::vector<TimedPlace>& trajectory) {
  constexpr double kRounding = 1e-6;      // [s]
  constexpr std::size_t kMostRows = 600;  // of 0.1 s
  requireAhead(now, trajectory);
  const TimedPlace here{now, ego.state.position};
  std::vector<Eigen::Vector2d> places;
  for (std::size_t row = 1; row <= kMostRows; ++row) {
    const double time = now + traffic::kRolloutStep * static_cast<double>(row);
    if (time > trajectory.back().time + kRounding && row > 1) break;
    places.push_back(placeAt(time, here, trajectory));
  }
  const PlanFollower follower{ego.state.position, geometry::direction(ego.state.heading),
                              ego.state.speed};
  return tracker_.track(follower, {places.data(), places.size()});
}

}  // namespace cdiff::planning
