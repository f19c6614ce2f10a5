// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/interaction_measures.h"

#include <algorithm>
#include <cmath>

#include "metrics/ttc_2d.h"

namespace cdiff::metrics {
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
  keepSmaller(interaction.ttc_2d, time);
  if (other.role == traffic::VehicleRole::kCbv) keepSmaller(interaction.ttc_2d_cbv, time);
  if (!options.variants) return;
  keepSmaller(interaction.ttc_lon_lat, within(longitudinalLateralTimeToCollision(ego, box)));
  keepSmaller(interaction.rift_ttc, riftTimeToCollision(ego, box));
  keepSmaller(interaction.rift_act, riftApproachTime(ego, box));
}

bool usable(const Vehicle& vehicle) {
  return vehicle.state.position.allFinite() && std::isfinite(vehicle.state.heading) &&
         std::isfinite(vehicle.state.speed);
}

}  // namespace

Interaction interactionOf(const Vehicle& ego, const traffic::TrafficSnapshot& snapshot,
                          const InteractionOptions& options) {
  Interaction interaction;
  if (!usable(ego)) return interaction;
  const MovingBox ego_box = movingBox(ego);
  for (const Vehicle& other : snapshot.vehicles) {
    if (&other == &ego || !usable(other) || traffic::onDifferentLevels(ego, other)) continue;
    const double distance = (other.state.position - ego.state.position).norm();
    keepNearer(interaction.nearest_distance, ego, other, distance);
    if (distance <= options.radius) keepTimes(interaction, ego_box, other, options);
  }
  return interaction;
}

}  // namespace cdiff::metrics
