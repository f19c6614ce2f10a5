// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planning/windowed_pid.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "e2e_cdiff/core/angle.h"

namespace cdiff::planning {

void PidGains::describe(core::OptionsVisitor& visitor, const std::string& name,
                        const std::string& output, const std::string& note) {
  constexpr double kLargest = 20.0;
  const auto gain = [&](const std::string& key, const std::string& text, double& value) {
    visitor.number({key.c_str(), "", text.c_str()}, value, 0.0, kLargest);
  };
  gain(name + "_kp", "Proportional gain of the " + output + note + ".", kp);
  gain(name + "_ki", "Gain of the mean error of the " + output + ".", ki);
  gain(name + "_kd", "Gain of the last error change of the " + output + ".", kd);
}

WindowedPid::WindowedPid(const PidGains& gains, std::int64_t window)
    : gains_(gains), errors_(static_cast<std::size_t>(window), 0.0) {}

/// The sum runs from the oldest error to the newest.
double WindowedPid::update(double error) {
  const double change = error - last_;
  last_ = error;
  errors_[oldest_] = error;
  oldest_ = oldest_ + 1 == errors_.size() ? 0 : oldest_ + 1;
  const auto begin = errors_.begin() + static_cast<std::ptrdiff_t>(oldest_);
  const double sum =
      std::accumulate(errors_.begin(), begin, std::accumulate(begin, errors_.end(), 0.0));
  return gains_.kp * error + gains_.ki * sum / static_cast<double>(errors_.size()) +
         gains_.kd * change;
}

void PlanPidOptions::describe(core::OptionsVisitor& visitor) {
  turn.describe(visitor, "turn", "steering");
  speed.describe(visitor, "speed", "throttle");
  visitor.integer({"window", "", "Errors in the means."}, window, 1, 1000);
  visitor.number({"speed_error_limit", "m/s", "Largest error of the speed that counts."},
                 speed_error_limit, 0.01, 40.0);
  visitor.number({"max_throttle", "", "Largest throttle."}, max_throttle, 0.0, 1.0);
  visitor.number({"brake_speed", "m/s", "It brakes if the desired speed is lower."}, brake_speed,
                 0.0, 10.0);
  visitor.number({"brake_ratio", "", "It brakes if speed / desired speed is higher."}, brake_ratio,
                 1.0, 10.0);
}

PlanPids::PlanPids(const PlanPidOptions& options)
    : options_(options),
      turn_(options.turn, options.window),
      speed_(options.speed, options.window) {}

bool PlanPids::brakes(double speed, double desired_speed) const {
  return desired_speed < options_.brake_speed || speed > options_.brake_ratio * desired_speed;
}

traffic::ControlAction PlanPids::track(double speed, double desired_speed, double turn_error) {
  const bool brake = brakes(speed, desired_speed);
  const double turn = turn_.update(brake && !options_.steers_while_braking ? 0.0 : turn_error);
  const double drive =
      speed_.update(std::clamp(desired_speed - speed, 0.0, options_.speed_error_limit));
  traffic::ControlAction action;
  action.steer = std::clamp(turn, -1.0, 1.0);
  action.throttle = brake ? 0.0 : std::clamp(drive, 0.0, options_.max_throttle);
  action.brake = brake ? 1.0 : 0.0;
  return action;
}

double turnErrorToward(const Eigen::Vector2d& place) {
  return std::atan2(place.y(), place.x()) / (0.5 * core::kPi);
}

}  // namespace cdiff::planning
