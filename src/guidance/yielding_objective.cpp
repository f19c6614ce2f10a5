// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "guidance/yielding_objective.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "guidance/right_of_way.h"

namespace cdiff::guidance {
namespace {

constexpr double kFree = std::numeric_limits<double>::infinity();
constexpr double kGentleAcceleration = 1.5;  // [m/s^2]
constexpr double kSlowest = 0.1;             // speed that arrivals are divided by at least [m/s]

/// Where another vehicle, as it is forecast, meets the strip.
struct Encounter {
  std::vector<Stretch> rows;
  std::size_t first = 0;  ///< row that meets; their number where none does
  Stretch swept;          ///< of all rows

  Encounter(const RouteStrip& strip, const OtherMotion& other) {
    for (const traffic::VehicleState& state : other.predicted) {
      rows.push_back(strip.meeting(boxOf(state.pose(), other.dimensions)));
      if (!rows.back().empty()) {
        swept.add(rows.back().begin);
        swept.add(rows.back().end);
      } else if (swept.empty()) {
        ++first;
      }
    }
  }
  bool never() const { return swept.empty(); }
};

/// When the vehicle is at an arc length, accelerating gently to its target speed [s].
double arrivalAt(const GuidanceScene& scene, double arc_length) {
  const double way = std::max(0.0, arc_length - scene.route_arc_length);
  const double speed = std::max(0.0, scene.state.speed);
  const double top = std::max(speed, scene.target_speed);
  const double to_top = (top * top - speed * speed) / (2.0 * kGentleAcceleration);
  if (way >= to_top)
    return (top - speed) / kGentleAcceleration + (way - to_top) / std::max(top, kSlowest);
  return (std::sqrt(speed * speed + 2.0 * kGentleAcceleration * way) - speed) / kGentleAcceleration;
}

/// Whether a vehicle that meets the planned one where that is now is before it: with its center,
/// or, where it moves and so will be gone, with a part of it ahead of the front bumper.
bool isBefore(const GuidanceScene& scene, const OtherMotion& other) {
  constexpr double kMoves = 0.5;  // [m/s]
  const Eigen::Vector2d forward = geometry::direction(scene.state.heading);
  const double center = forward.dot(other.now.position - scene.state.position);
  const double front =
      center + geometry::halfExtent(boxOf(other.now.pose(), other.dimensions), forward);
  return center > 0.0 || (other.now.speed > kMoves && front > 0.5 * scene.dimensions.length);
}

/// Whether the vehicle lets the other through.
bool givesWay(const GuidanceScene& scene, const OtherMotion& other, const Encounter& met,
              double margin) {
  if (met.never()) return false;
  if (other.by_same_rules) return other.goes_first;
  if (met.rows[met.first].begin <= scene.route_arc_length) return isBefore(scene, other);
  const double enters = traffic::kRolloutStep * static_cast<double>(met.first + 1);
  return arrivalAt(scene, met.swept.end) + margin > enters;
}

/// Those to give way to: the vehicles around, and the other one.
std::vector<const OtherMotion*> othersOf(const GuidanceScene& scene) {
  std::vector<const OtherMotion*> others;
  for (const OtherMotion& vehicle : scene.traffic) others.push_back(&vehicle);
  const bool on_level =
      scene.other != nullptr &&
      !traffic::onDifferentLevels(scene.other->now.elevation, scene.state.elevation);
  if (on_level) others.push_back(scene.other);
  return others;
}

/// Lowers the limits to what `met` leaves, from `margin` [s] before each row to `margin` after it.
void limitBy(const std::vector<Stretch>& met, double margin, std::vector<double>& limits) {
  const auto rows = static_cast<long>(std::min(met.size(), limits.size()));
  const long spread = std::lround(margin / traffic::kRolloutStep);
  for (long row = 0; row < rows; ++row) {
    const double begin = met[static_cast<std::size_t>(row)].begin;
    for (long t = std::max(0L, row - spread); t <= std::min(rows - 1, row + spread); ++t) {
      double& limit = limits[static_cast<std::size_t>(t)];
      limit = std::min(limit, begin);
    }
  }
}

/// Arc length of a position on the route, straight on beyond its ends, and the heading there.
geometry::Projection placeOn(const GuidanceScene& scene, const Eigen::Vector2d& position) {
  const geometry::Polyline& path = scene.route->path();
  geometry::Projection place = path.projectNear(position, scene.route_arc_length, kRouteReach);
  if (place.arc_length > 0.0 && place.arc_length < path.length()) return place;
  place.arc_length +=
      geometry::direction(place.heading).dot(position - path.positionAt(place.arc_length));
  return place;
}

}  // namespace

void YieldingObjective::describe(core::OptionsVisitor& visitor) {
  visitor.number({"longitudinal_gap", "m", "Kept between bumpers."}, longitudinal_gap, 0.0, 50.0);
  visitor.number({"lateral_gap", "m", "Kept between sides."}, lateral_gap, 0.0, 5.0);
  visitor.number({"margin", "s", "Time kept before and after the other vehicle."}, margin, 0.0,
                 3.0);
}

void YieldingObjective::prepare(const GuidanceScene& scene) {
  limits_.clear();
  const std::vector<const OtherMotion*> others = othersOf(scene);
  if (scene.route == nullptr || scene.route->empty() || others.empty()) return;
  const std::size_t rows = others.front()->predicted.size();
  const RouteStrip strip(
      {{}, scene.state, scene.dimensions, scene.route, scene.route_arc_length, scene.target_speed},
      {longitudinal_gap, lateral_gap}, traffic::kRolloutStep * static_cast<double>(rows));
  limits_.assign(rows, kFree);
  for (const OtherMotion* other : others) {
    const Encounter met(strip, *other);
    if (givesWay(scene, *other, met, margin)) limitBy(met.rows, margin, limits_);
  }
}

double YieldingObjective::evaluate(const GuidanceScene& scene, const traffic::Rollout& rollout,
                                   traffic::Rollout& gradient) const {
  double sum = 0.0;
  const auto known = static_cast<Eigen::Index>(limits_.size());
  for (Eigen::Index row = 0; row < std::min(rollout.rows(), known); ++row) {
    const double limit = limits_[static_cast<std::size_t>(row)];
    if (limit == kFree) continue;
    const geometry::Projection place = placeOn(scene, positionOnMap(scene, rollout, row));
    const double beyond = place.arc_length - limit;
    if (beyond <= 0.0) continue;
    sum += beyond * beyond;
    addPositionGradient(scene, 2.0 * beyond * geometry::direction(place.heading), row, gradient);
  }
  return sum;
}

std::unique_ptr<Objective> YieldingObjective::clone() const {
  return std::make_unique<YieldingObjective>(*this);
}

}  // namespace cdiff::guidance
