// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/cbv_measures.h"

#include <algorithm>
#include <cmath>

#include "metrics/collisions_per_km.h"

namespace cdiff::metrics {

void CbvMeasures::observe(const std::vector<CbvSighting>& cbvs, bool decision_tick) {
  std::map<std::string, Eigen::Vector2d> positions;
  for (const CbvSighting& cbv : cbvs) {
    const traffic::Vehicle& vehicle = *cbv.vehicle;
    if (!vehicle.state.position.allFinite()) continue;
    const auto last = last_positions_.find(vehicle.id);
    if (last != last_positions_.end()) {
      distance_ += (vehicle.state.position - last->second).norm();
    } else {
      driven_.insert(vehicle.id);
    }
    positions[vehicle.id] = vehicle.state.position;
    off_road_.add(cbv.off_road);
    corner_off_road_.add(cbv.off_road || cbv.corner_off_road);
    if (cbv.ego_distance && std::isfinite(*cbv.ego_distance)) {
      const auto [closest, first] = closest_.emplace(vehicle.id, *cbv.ego_distance);
      if (!first) closest->second = std::min(closest->second, *cbv.ego_distance);
    }
    if (!decision_tick) continue;
    ++decisions_;
    if (std::isfinite(vehicle.state.speed)) speeds_.push_back(vehicle.state.speed);
    if (cbv.wanted_speed) speed_errors_.add(std::abs(vehicle.state.speed - *cbv.wanted_speed));
    if (std::isfinite(vehicle.acceleration)) accelerations_.push_back(vehicle.acceleration);
  }
  last_positions_.swap(positions);
}

void CbvMeasures::countCollision(bool with_ego) {
  ++collisions_;
  if (with_ego) ++ego_collisions_;
}

Measure CbvMeasures::offRoadRatePercent() const { return off_road_.measure(kNoCbv); }

Measure CbvMeasures::cornerOffRoadRatePercent() const { return corner_off_road_.measure(kNoCbv); }

Measure CbvMeasures::collisionsPerKilometre() const {
  return metrics::collisionsPerKilometre(collisions_, distance_, count());
}

Measure CbvMeasures::egoCollisionsPerKilometre() const {
  return metrics::collisionsPerKilometre(ego_collisions_, distance_, count());
}

Measure CbvMeasures::speedError() const { return speed_errors_.measure("m/s", kNoCbv).mean; }

DistributionMeasure CbvMeasures::closestDistances() const {
  SampleStatistics distances;
  for (const auto& [id, distance] : closest_) distances.add(distance);
  return distances.measure("m", driven_.empty() ? kNoCbv : "the ego was never seen");
}

Measure CbvMeasures::closestDistance() const { return closestDistances().mean; }

Measure CbvMeasures::minimumDistance() const { return closestDistances().minimum; }

}  // namespace cdiff::metrics
