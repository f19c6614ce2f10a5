// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/formulas/ttc_2d.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace cdiff::metrics {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool finite(const MovingBox& moving) {
  const auto& box = moving.box;
  return box.center.allFinite() && moving.velocity.allFinite() && std::isfinite(box.heading) &&
         std::isfinite(box.length) && std::isfinite(box.width);
}

/// Times during which the shadows of two boxes on an axis overlap.
struct Interval {
  double begin = -kInfinity;
  double end = kInfinity;
};

/// Times at which |offset + rate t| <= reach.
Interval overlapTimes(double offset, double rate, double reach) {
  if (rate == 0.0) {
    return std::abs(offset) <= reach ? Interval{} : Interval{kInfinity, -kInfinity};
  }
  const double first = (-reach - offset) / rate;
  const double second = (reach - offset) / rate;
  return {std::min(first, second), std::max(first, second)};
}

using Axes = std::array<Eigen::Vector2d, 2>;

/// Forward and left unit vectors.
Axes axesOf(const geometry::OrientedBox& box) {
  const Eigen::Vector2d forward = geometry::direction(box.heading);
  return {forward, geometry::leftNormal(forward)};
}

/// Half the shadow of a box on an axis.
double reach(const geometry::OrientedBox& box, const Axes& axes, const Eigen::Vector2d& axis) {
  return 0.5 * (box.length * std::abs(axes[0].dot(axis)) + box.width * std::abs(axes[1].dot(axis)));
}

/// Distance along `ray` (a unit vector) from `origin` to the segment, negative behind; nullopt when
/// its line misses.
std::optional<double> rayToSegment(const Eigen::Vector2d& origin, const Eigen::Vector2d& ray,
                                   const Eigen::Vector2d& begin, const Eigen::Vector2d& end) {
  const Eigen::Vector2d side = end - begin;
  const double denominator = geometry::cross(ray, side);
  if (denominator == 0.0) return std::nullopt;
  const Eigen::Vector2d offset = begin - origin;
  const double along_side = geometry::cross(offset, ray) / denominator;
  if (along_side < 0.0 || along_side > 1.0) return std::nullopt;
  return geometry::cross(offset, side) / denominator;
}

using Outline = std::array<Eigen::Vector2d, 4>;

Outline outlineOf(const geometry::OrientedBox& box, OutlineOrder order) {
  const Outline ring = box.corners();
  if (order == OutlineOrder::kRing) return ring;
  return {ring[0], ring[1], ring[3], ring[2]};
}

double roundedToCentiseconds(double time) { return std::nearbyint(100.0 * time) / 100.0; }

/// Shortest positive distance from a corner along `ray` onto an outline; 0 when a corner has the
/// outline behind it and then before it (it lies inside); infinity when no ray hits.
double rayCast(const Outline& corners, const Eigen::Vector2d& ray, const Outline& outline) {
  double shortest = kInfinity;
  for (const Eigen::Vector2d& corner : corners) {
    bool behind = false;
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const auto hit = rayToSegment(corner, ray, outline[i], outline[(i + 1) % outline.size()]);
      if (!hit) continue;
      if (*hit < 0.0) {
        behind = true;
      } else if (behind) {
        return 0.0;
      } else {
        shortest = std::min(shortest, *hit);
      }
    }
  }
  return shortest;
}

/// One direction of the paper's wording: the gap closes at `closing`, and then the other direction
/// must overlap.
double axisTime(double gap, double closing, double other_offset, double other_rate,
                double other_reach) {
  if (gap < 0.0 || closing <= 0.0) return kInfinity;
  const double time = gap / closing;
  return std::abs(other_offset + other_rate * time) <= other_reach ? time : kInfinity;
}

}  // namespace

std::optional<double> timeToCollision2d(const MovingBox& first, const MovingBox& second) {
  if (!finite(first) || !finite(second)) return std::nullopt;
  const Eigen::Vector2d offset = second.box.center - first.box.center;
  const Eigen::Vector2d rate = second.velocity - first.velocity;
  const Axes first_axes = axesOf(first.box);
  const Axes second_axes = axesOf(second.box);
  Interval common;
  for (const Axes* axes : {&first_axes, &second_axes}) {
    for (const Eigen::Vector2d& axis : *axes) {
      const double both = reach(first.box, first_axes, axis) + reach(second.box, second_axes, axis);
      const Interval times = overlapTimes(offset.dot(axis), rate.dot(axis), both);
      common.begin = std::max(common.begin, times.begin);
      common.end = std::min(common.end, times.end);
      if (common.begin > common.end || common.end < 0.0) return std::nullopt;
    }
  }
  return std::max(common.begin, 0.0);
}

std::optional<double> rayCastTimeToCollision(const MovingBox& first, const MovingBox& second,
                                             OutlineOrder order) {
  if (!finite(first) || !finite(second)) return std::nullopt;
  const Eigen::Vector2d offset = second.box.center - first.box.center;
  const Eigen::Vector2d closing = first.velocity - second.velocity;
  const double speed = closing.norm();
  if (speed == 0.0 || closing.dot(offset) < 0.0) return std::nullopt;
  const Eigen::Vector2d ray = closing / speed;
  const Outline first_outline = outlineOf(first.box, order);
  const Outline second_outline = outlineOf(second.box, order);
  const double distance = std::min(rayCast(first_outline, ray, second_outline),
                                   rayCast(second_outline, -ray, first_outline));
  if (!std::isfinite(distance)) return std::nullopt;
  return distance / speed;
}

std::optional<double> riftTimeToCollision(const MovingBox& first, const MovingBox& second) {
  const auto time = rayCastTimeToCollision(first, second, OutlineOrder::kBowTie);
  return time ? std::optional<double>(roundedToCentiseconds(*time)) : std::nullopt;
}

std::optional<double> riftApproachTime(const MovingBox& first, const MovingBox& second) {
  if (!finite(first) || !finite(second)) return std::nullopt;
  const Eigen::Vector2d offset = second.box.center - first.box.center;
  const double distance = offset.norm();
  if (distance == 0.0) return std::nullopt;
  const double closing = (first.velocity - second.velocity).dot(offset) / distance;
  if (!(closing > 0.0)) return std::nullopt;
  double shortest = kInfinity;
  for (const Eigen::Vector2d& mine : first.box.corners()) {
    for (const Eigen::Vector2d& other : second.box.corners())
      shortest = std::min(shortest, (other - mine).norm());
  }
  return roundedToCentiseconds(shortest / closing);
}

std::optional<double> longitudinalLateralTimeToCollision(const MovingBox& first,
                                                         const MovingBox& second) {
  if (!finite(first) || !finite(second)) return std::nullopt;
  const geometry::Pose2d frame{first.box.center, first.box.heading};
  const Eigen::Vector2d offset = frame.toBody(second.box.center);
  const Eigen::Vector2d rate = frame.toBody(first.box.center + second.velocity - first.velocity);
  const double reach_lon = 0.5 * (first.box.length + second.box.length);
  const double reach_lat = 0.5 * (first.box.width + second.box.width);
  const double gap_lon = std::abs(offset.x()) - reach_lon;
  const double gap_lat = std::abs(offset.y()) - reach_lat;
  if (gap_lon <= 0.0 && gap_lat <= 0.0) return 0.0;
  const double closing_lon = offset.x() > 0.0 ? -rate.x() : rate.x();
  const double closing_lat = offset.y() > 0.0 ? -rate.y() : rate.y();
  const double time = std::min(axisTime(gap_lon, closing_lon, offset.y(), rate.y(), reach_lat),
                               axisTime(gap_lat, closing_lat, offset.x(), rate.x(), reach_lon));
  return std::isfinite(time) ? std::optional<double>(time) : std::nullopt;
}

namespace {

using traffic::Vehicle;

MovingBox movingBox(const Vehicle& vehicle) { return {vehicle.box(), vehicle.state.velocity()}; }

double halfDiagonal(const Vehicle& vehicle) {
  return 0.5 * std::hypot(vehicle.dimensions.length, vehicle.dimensions.width);
}

void keepSmaller(std::optional<double>& smallest, const std::optional<double>& value) {
  if (value && (!smallest || *value < *smallest)) smallest = value;
}

/// Computes the distance of the boxes only where the circles around them leave a chance of a
/// smaller one.
void keepNearer(std::optional<double>& nearest, const Vehicle& ego, const Vehicle& other,
                double center_distance) {
  const double least = center_distance - halfDiagonal(ego) - halfDiagonal(other);
  if (nearest && least >= *nearest) return;
  keepSmaller(nearest, geometry::distance(ego.box(), other.box()));
}

/// One vehicle within the radius.
void keepTimes(Interaction& interaction, const MovingBox& ego, const Vehicle& other,
               const InteractionOptions& options) {
  const auto within = [&](const std::optional<double>& time) {
    return time && *time <= options.time_limit ? time : std::nullopt;
  };
  const MovingBox box = movingBox(other);
  const auto time = within(timeToCollision2d(ego, box));
  if (time && (!interaction.ttc_2d || *time < *interaction.ttc_2d))
    interaction.ttc_2d_partner = &other;
  keepSmaller(interaction.ttc_2d, time);
  if (other.role == traffic::VehicleRole::kCbv) keepSmaller(interaction.ttc_2d_cbv, time);
  if (!options.variants) return;
  keepSmaller(interaction.ttc_lon_lat, within(longitudinalLateralTimeToCollision(ego, box)));
  keepSmaller(interaction.rift_ttc, riftTimeToCollision(ego, box));
  keepSmaller(interaction.rift_act, riftApproachTime(ego, box));
}

bool hasFiniteState(const Vehicle& vehicle) {
  return vehicle.state.position.allFinite() && std::isfinite(vehicle.state.heading) &&
         std::isfinite(vehicle.state.speed);
}

}  // namespace

Interaction interactionOf(const Vehicle& ego, const traffic::TrafficSnapshot& snapshot,
                          const InteractionOptions& options) {
  Interaction interaction;
  if (!hasFiniteState(ego)) return interaction;
  const MovingBox ego_box = movingBox(ego);
  for (const Vehicle& other : snapshot.vehicles) {
    if (&other == &ego || !hasFiniteState(other) || traffic::onDifferentLevels(ego, other))
      continue;
    const double distance = (other.state.position - ego.state.position).norm();
    keepNearer(interaction.nearest_distance, ego, other, distance);
    if (distance <= options.radius) keepTimes(interaction, ego_box, other, options);
  }
  return interaction;
}

}  // namespace cdiff::metrics
