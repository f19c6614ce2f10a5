// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/metrics/ego_measures.h"

#include "e2e_cdiff/metrics/driving_score.h"

namespace cdiff::metrics {

EgoMeasures::EgoMeasures(const map::Route& route, double completion_percent,
                         double completion_distance) {
  if (!route.empty()) progress_.emplace(route, completion_percent, completion_distance);
}

void EgoMeasures::observe(const traffic::Vehicle& ego, bool off_road) {
  id_ = ego.id;
  const Eigen::Vector2d position = ego.state.position;
  if (!position.allFinite()) return;
  if (progress_) progress_->update(position);
  off_road_.add(off_road);
  if (last_position_) {
    const double moved = (position - *last_position_).norm();
    distance_ += moved;
    if (off_road) outside_distance_ += moved;
  }
  last_position_ = position;
}

double EgoMeasures::routeCompletionPercent() const {
  return progress_ ? progress_->percent() : 0.0;
}

Measure EgoMeasures::offRoadPercent() const { return off_road_.measure("the ego was never seen"); }

double EgoMeasures::outsidePercent() const {
  return distance_ > 0.0 ? 100.0 * outside_distance_ / distance_ : 0.0;
}

double EgoMeasures::drivingScore() const {
  Infractions infractions;
  infractions.vehicle_collisions = collisions_;
  infractions.outside_lanes_percent = outsidePercent();
  return metrics::drivingScore(routeCompletionPercent(), infractions, ScoreRules::kRiftDev10);
}

}  // namespace cdiff::metrics
