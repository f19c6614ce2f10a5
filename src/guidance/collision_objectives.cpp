// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "guidance/collision_objectives.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "guidance/right_of_way.h"

namespace cdiff::guidance {
namespace {

constexpr double kSmallDistance = 0.1;  // [m] gives the distance a derivative where centers meet

/// Derivative of softplus.
double logistic(double x) {
  if (x >= 0.0) return 1.0 / (1.0 + std::exp(-x));
  const double power = std::exp(x);
  return power / (1.0 + power);
}

/// Whether all of the other vehicle is behind the planned one, and does not come.
bool standsBehind(const GuidanceScene& scene) {
  constexpr double kStands = 0.5;  // [m/s]
  const traffic::VehicleState& other = scene.other->now;
  const Eigen::Vector2d forward = geometry::direction(scene.state.heading);
  const double front = forward.dot(other.position - scene.state.position) +
                       geometry::halfExtent(boxOf(other.pose(), scene.other->dimensions), forward);
  return other.speed < kStands && front < -0.5 * scene.dimensions.length;
}

double halfDiagonal(const traffic::VehicleDimensions& box) {
  return 0.5 * std::hypot(box.length, box.width);
}

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

double softplus(double x) { return std::max(x, 0.0) + std::log1p(std::exp(-std::abs(x))); }

void Proximity::describe(core::OptionsVisitor& visitor) {
  visitor.number({"buffer", "m", "Distance kept beyond the boxes' half diagonals."}, buffer, 0.0,
                 50.0);
  visitor.number({"kappa", "m", "Softness of the safety distance; the pull reaches some of it."},
                 kappa, 0.05, 50.0);
  visitor.number({"lambda", "", "Height of the bump around the other vehicle."}, lambda, 0.0,
                 1000.0);
  visitor.number({"sigma", "m", "Width of the bump."}, sigma, 0.1, 100.0);
}

double Proximity::safeDistance(const GuidanceScene& scene) const {
  return halfDiagonal(scene.dimensions) + halfDiagonal(scene.other->dimensions) + buffer;
}

double Proximity::evaluate(const GuidanceScene& scene, const traffic::Rollout& rollout,
                           double factor, traffic::Rollout& gradient) const {
  if (scene.other == nullptr) return 0.0;
  if (traffic::onDifferentLevels(scene.other->now.elevation, scene.state.elevation)) return 0.0;
  const double safe_distance = safeDistance(scene);
  const auto known = static_cast<Eigen::Index>(scene.other->predicted.size());
  double sum = 0.0;
  for (Eigen::Index row = 0; row < std::min(rollout.rows(), known); ++row) {
    const Eigen::Vector2d away = positionOnMap(scene, rollout, row) -
                                 scene.other->predicted[static_cast<std::size_t>(row)].position;
    const double squared = away.squaredNorm() + kSmallDistance * kSmallDistance;
    const double distance = std::sqrt(squared);
    const double closeness = (safe_distance - distance) / kappa;
    const double bump = lambda * std::exp(-squared / (2.0 * sigma * sigma));
    sum += softplus(closeness) + bump;
    const double by_distance = -logistic(closeness) / kappa - bump * distance / (sigma * sigma);
    addPositionGradient(scene, factor * by_distance / distance * away, row, gradient);
  }
  return factor * sum;
}

void CollisionAvoidanceObjective::describe(core::OptionsVisitor& visitor) {
  proximity.describe(visitor);
}

double CollisionAvoidanceObjective::evaluate(const GuidanceScene& scene,
                                             const traffic::Rollout& rollout,
                                             traffic::Rollout& gradient) const {
  return proximity.evaluate(scene, rollout, 1.0, gradient);
}

std::unique_ptr<Objective> CollisionAvoidanceObjective::clone() const {
  return std::make_unique<CollisionAvoidanceObjective>(*this);
}

void CollisionSeekingObjective::describe(core::OptionsVisitor& visitor) {
  proximity.describe(visitor);
  visitor.text({"gate", "", "How the pull sets in at the trigger distance."}, gate,
               {"smooth", "hard"});
  visitor.number({"trigger_distance", "m", "Distance now up to which it acts fully."},
                 trigger_distance, 0.0, 500.0);
  visitor.number({"trigger_width", "m", "Distance beyond it over which the smooth gate closes."},
                 trigger_width, 0.01, 500.0);
  visitor.flag({"leave_behind", "", "Whether to drive on from a vehicle that stands behind."},
               leave_behind);
}

double CollisionSeekingObjective::gateAt(double distance) const {
  const double beyond = distance - trigger_distance;
  if (beyond <= 0.0) return 1.0;
  if (gate == "hard" || beyond >= trigger_width) return 0.0;
  const double share = beyond / trigger_width;
  return 1.0 - share * share * (3.0 - 2.0 * share);
}

double CollisionSeekingObjective::evaluate(const GuidanceScene& scene,
                                           const traffic::Rollout& rollout,
                                           traffic::Rollout& gradient) const {
  if (scene.other == nullptr) return 0.0;
  if (leave_behind && standsBehind(scene)) return 0.0;
  const double eta = gateAt((scene.other->now.position - scene.state.position).norm());
  if (eta <= 0.0) return 0.0;
  return proximity.evaluate(scene, rollout, -eta, gradient);
}

std::unique_ptr<Objective> CollisionSeekingObjective::clone() const {
  return std::make_unique<CollisionSeekingObjective>(*this);
}

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
