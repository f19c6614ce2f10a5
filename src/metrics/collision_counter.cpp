// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/collision_counter.h"

namespace cdiff::metrics {

void CollisionCounter::observe(double time, const traffic::VehicleState& ego,
                               const std::string& partner) {
  ++contacts_;
  if (ego.speed < options_.collision_minimum_speed || repeats(time, ego, partner)) return;
  ++count_;
  last_ = {time, ego.position, partner};
}

bool CollisionCounter::repeats(double time, const traffic::VehicleState& ego,
                               const std::string& partner) const {
  if (!last_) return false;
  const bool same_partner =
      partner == last_->partner && time - last_->time < options_.collision_repeat_time;
  const double distance = (ego.position - last_->position).norm();
  return same_partner || distance < options_.collision_repeat_distance;
}

}  // namespace cdiff::metrics
