// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planning/plan_tracker.h"

#include <algorithm>
#include <cmath>

#include "core/option_fields.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/geometry/shapes.h"

namespace cdiff::planning {
namespace {

constexpr std::size_t kSecond = 10;     // [rows]
constexpr std::size_t kHalfSecond = 5;  // [rows]

/// Of plans shorter than 2 s only half seconds count, not whole ones.
std::size_t spacingIn(PlanPlaces plan, std::size_t rows) {
  return std::min(plan.count < 2 * kSecond ? std::min(rows, kHalfSecond) : rows, plan.count);
}

std::size_t rowCount(double time) {
  return static_cast<std::size_t>(std::lround(time / traffic::kRolloutStep));
}

std::vector<Eigen::Vector2d> rowsOf(const Eigen::MatrixX2d& places) {
  std::vector<Eigen::Vector2d> rows;
  rows.reserve(static_cast<std::size_t>(places.rows()));
  for (const auto& place : places.rowwise()) rows.emplace_back(place.transpose());
  return rows;
}

}  // namespace

PlanTrackerOptions PlanTrackerOptions::named(const std::string& name) {
  PlanTrackerOptions options;
  if (name == kTunedTracker) return options;
  if (name != kPublishedTracker) {
    throw core::InputError("tracker '" + name + "' is not known; expected one of {" +
                           kTunedTracker + ", " + kPublishedTracker + "}");
  }
  options.tracker = name;
  options.pids = PlanPidOptions();
  options.aim_period = 1.0;
  options.look_ahead_time = 0.5;
  options.look_ahead_distance = 2.5;
  options.look_ahead_minimum = 5.0;
  options.look_ahead_maximum = 8.0;
  options.speed_horizon = 8.0;
  options.steer_while_braking = false;
  return options;
}

void PlanTrackerOptions::describe(core::OptionsVisitor& visitor,
                                  const std::vector<std::string>& further) {
  describeName(visitor, further);
  pids.describe(visitor);
  visitor.number(
      {"aim_period", "s", "From one place of the plan that may be aimed at to the next."},
      aim_period, traffic::kRolloutStep, 2.0);
  visitor.number({"look_ahead_time", "s", "Look-ahead per speed."}, look_ahead_time, 0.0, 10.0);
  visitor.number({"look_ahead_distance", "m", "Look-ahead at standstill, before its limits."},
                 look_ahead_distance, 0.0, 50.0);
  visitor.number({"look_ahead_minimum", "m", "Least look-ahead."}, look_ahead_minimum, 0.1, 50.0);
  visitor.number({"look_ahead_maximum", "m", "Largest look-ahead."}, look_ahead_maximum, 0.1, 50.0);
  visitor.number({"speed_horizon", "s", "Part of the plan over which the desired speed is a mean."},
                 speed_horizon, 1.0, 60.0);
  visitor.flag({"steer_while_braking", "", "Whether it steers while it brakes."},
               steer_while_braking);
}

/// A visitor that gives another name is one that loads.
void PlanTrackerOptions::describeName(core::OptionsVisitor& visitor,
                                      const std::vector<std::string>& further) {
  std::vector<std::string> names = {kTunedTracker, kPublishedTracker};
  names.insert(names.end(), further.begin(), further.end());
  std::string name = tracker;
  visitor.text({"tracker", "",
                "What follows the plan; keys beside it (aim_period, look_ahead_*, speed_*, turn_* "
                "...) change single values of it."},
               name, names);
  if (name == tracker) return;
  const bool is_further = std::find(further.begin(), further.end(), name) != further.end();
  *this = named(is_further ? kTunedTracker : name);
  tracker = name;
}

void PlanTrackerOptions::validate() const {
  if (look_ahead_minimum <= look_ahead_maximum) return;
  throw core::InputError(
      "tracker of plans: look_ahead_minimum is " + core::formatNumber(look_ahead_minimum) +
      " m, but look_ahead_maximum only " + core::formatNumber(look_ahead_maximum) + " m");
}

double PlanTrackerOptions::lookAhead(double speed) const {
  return std::clamp(look_ahead_time * speed + look_ahead_distance, look_ahead_minimum,
                    look_ahead_maximum);
}

void nameTrackers(const PlannerOptionsTable& named, PlannerOptionsTable& base) {
  const std::string end = ".tracker";
  for (const auto& [key, value] : core::flatOptions(named)) {
    if (key.size() > end.size() && key.compare(key.size() - end.size(), end.size(), end) == 0)
      core::overrideOption(key + "=" + value, "key '" + key + "'", base);
  }
}

double desiredSpeed(const Eigen::Vector2d& position, PlanPlaces plan, double horizon) {
  const std::size_t spacing = spacingIn(plan, kSecond);
  if (spacing == 0) return 0.0;
  const std::size_t end = std::max(spacing, std::min(plan.count, rowCount(horizon)));
  double length = 0.0;
  std::size_t rows = 0;
  Eigen::Vector2d last = position;
  for (std::size_t row = spacing; row <= end; row += spacing) {
    const Eigen::Vector2d& place = plan.first[row - 1];
    length += (place - last).norm();
    last = place;
    rows = row;
  }
  return length / (static_cast<double>(rows) * traffic::kRolloutStep);
}

double desiredSpeed(const Eigen::MatrixX2d& places, double horizon) {
  const std::vector<Eigen::Vector2d> rows = rowsOf(places);
  return desiredSpeed(Eigen::Vector2d::Zero(), {rows.data(), rows.size()}, horizon);
}

PlanTracker::PlanTracker(const PlanTrackerOptions& options)
    : options_(options),
      aim_rows_(std::max<std::size_t>(1, rowCount(options.aim_period))),
      pids_(options.pids) {
  options_.validate();
}

double PlanTracker::turnError(const PlanFollower& vehicle, PlanPlaces plan) const {
  const double look_ahead = options_.lookAhead(vehicle.speed);
  const std::size_t spacing = spacingIn(plan, aim_rows_);
  if (spacing == 0) return 0.0;
  Eigen::Vector2d aim = Eigen::Vector2d::Zero();
  double farthest = -1.0;  // squared, of those before the look-ahead
  for (std::size_t row = spacing; row <= plan.count; row += spacing) {
    const Eigen::Vector2d away = plan.first[row - 1] - vehicle.position;
    const double squared = away.squaredNorm();
    if (squared < look_ahead * look_ahead) {
      if (squared <= farthest) continue;
      farthest = squared;
      aim = away;
      continue;
    }
    if (farthest < 0.0 || std::sqrt(squared) - look_ahead < look_ahead - std::sqrt(farthest))
      aim = away;
    break;
  }
  if (aim.squaredNorm() < kNearestAim * kNearestAim) return 0.0;
  return turnErrorToward({vehicle.direction.dot(aim), geometry::cross(vehicle.direction, aim)});
}

traffic::ControlAction PlanTracker::track(const PlanFollower& vehicle, PlanPlaces plan) {
  const double desired = desiredSpeed(vehicle.position, plan, options_.speed_horizon);
  const bool steers = vehicle.speed >= kStandstill &&
                      (options_.steer_while_braking || !pids_.brakes(vehicle.speed, desired));
  return pids_.track(vehicle.speed, desired, steers ? turnError(vehicle, plan) : 0.0);
}

traffic::ControlAction PlanTracker::track(double speed, const Eigen::MatrixX2d& places) {
  const std::vector<Eigen::Vector2d> rows = rowsOf(places);
  PlanFollower vehicle;
  vehicle.speed = speed;
  return track(vehicle, {rows.data(), rows.size()});
}

}  // namespace cdiff::planning
