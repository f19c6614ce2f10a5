// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/ego_measures.h"

#include <utility>

namespace cdiff::metrics {

EgoMeasures::EgoMeasures(const map::Route& route, double completion_percent,
                         double completion_distance, EgoInfractions infractions)
    : infractions_(std::move(infractions)) {
  if (!route.empty()) progress_.emplace(route, completion_percent, completion_distance);
}

void EgoMeasures::observe(const traffic::Vehicle& ego, bool off_road,
                          const traffic::TrafficSnapshot& snapshot) {
  id_ = ego.id;
  const Eigen::Vector2d position = ego.state.position;
  if (!position.allFinite()) return;
  if (progress_) progress_->update(position);
  off_road_.add(off_road);
  infractions_.observe(ego, snapshot, progress_ ? progress_->arcLength() : 0.0);
}

void EgoMeasures::countCollision(const traffic::TrafficSnapshot& snapshot,
                                 const traffic::Contact& contact) {
  ++collisions_;
  infractions_.countCollision(snapshot, contact.first == id_ ? contact.second : contact.first);
}

double EgoMeasures::routeCompletionPercent() const {
  return progress_ ? progress_->percent() : 0.0;
}

Measure EgoMeasures::offRoadPercent() const { return off_road_.measure("the ego was never seen"); }

double EgoMeasures::drivingScore() const {
  return infractions_.drivingScore(routeCompletionPercent());
}

}  // namespace cdiff::metrics
