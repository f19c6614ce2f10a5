// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "guidance/traffic_avoidance_objective.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"

namespace cdiff::guidance {
namespace {

constexpr double kSameDirection = 60.0;  // largest difference of headings [deg]
constexpr double kSmallRadius = 0.01;    // gives rho a derivative at the other's center

/// A and B: reach along and across the other vehicle [m].
struct Reach {
  double along = 0.0;
  double across = 0.0;
};

/// A place in the other vehicle's frame [m].
struct Place {
  double along = 0.0;
  double across = 0.0;
};

/// A term and its derivatives by the place.
struct Term {
  double value = 0.0;
  double by_along = 0.0;
  double by_across = 0.0;
};

Place placeIn(const traffic::VehicleState& other, const Eigen::Vector2d& position) {
  const Eigen::Vector2d forward = geometry::direction(other.heading);
  const Eigen::Vector2d away = position - other.position;
  return {forward.dot(away), geometry::leftNormal(forward).dot(away)};
}

bool isAheadInLane(const GuidanceScene& scene, const OtherMotion& other, const Reach& reach) {
  const Place now = placeIn(other.now, scene.state.position);
  const double turned = core::angleDifference(scene.state.heading, other.now.heading);
  return now.along < 0.0 && std::abs(now.across) < reach.across &&
         std::abs(turned) < core::degreesToRadians(kSameDirection);
}

Term termBehind(const Place& place, const Reach& reach) {
  const double beyond = place.along + reach.along;
  const double share = place.across / reach.across;
  const double inside = 1.0 - share * share;
  if (beyond <= 0.0 || inside <= 0.0) return {};
  const double window = inside * inside;
  return {window * beyond * beyond, 2.0 * window * beyond,
          -4.0 * inside * share / reach.across * beyond * beyond};
}

Term termBeside(const Place& place, const Reach& reach) {
  const double u = place.along / reach.along;
  const double v = place.across / reach.across;
  const double rho = std::sqrt(u * u + v * v + kSmallRadius * kSmallRadius);
  if (rho >= 1.0) return {};
  const double missing = 1.0 - rho;
  const double area = reach.along * reach.along;
  const double by_rho = -2.0 * area * missing / rho;
  return {area * missing * missing, by_rho * u / reach.along, by_rho * v / reach.across};
}

}  // namespace

void TrafficAvoidanceObjective::describe(core::OptionsVisitor& visitor) {
  visitor.number({"longitudinal_gap", "m", "Kept between bumpers."}, longitudinal_gap, 0.0, 50.0);
  visitor.number({"lateral_gap", "m", "Kept between sides."}, lateral_gap, 0.0, 5.0);
}

double TrafficAvoidanceObjective::evaluate(const GuidanceScene& scene,
                                           const traffic::Rollout& rollout,
                                           traffic::Rollout& gradient) const {
  double sum = 0.0;
  for (const OtherMotion& other : scene.traffic) {
    const Reach reach{0.5 * (scene.dimensions.length + other.dimensions.length) + longitudinal_gap,
                      0.5 * (scene.dimensions.width + other.dimensions.width) + lateral_gap};
    const auto term = isAheadInLane(scene, other, reach) ? termBehind : termBeside;
    const auto known = static_cast<Eigen::Index>(other.predicted.size());
    for (Eigen::Index row = 0; row < std::min(rollout.rows(), known); ++row) {
      const traffic::VehicleState& then = other.predicted[static_cast<std::size_t>(row)];
      const Term found = term(placeIn(then, positionOnMap(scene, rollout, row)), reach);
      if (found.value == 0.0) continue;
      sum += found.value;
      const Eigen::Vector2d forward = geometry::direction(then.heading);
      addPositionGradient(
          scene, found.by_along * forward + found.by_across * geometry::leftNormal(forward), row,
          gradient);
    }
  }
  return sum;
}

std::unique_ptr<Objective> TrafficAvoidanceObjective::clone() const {
  return std::make_unique<TrafficAvoidanceObjective>(*this);
}

}  // namespace cdiff::guidance
