// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/logs/driving_log.h"

#include <algorithm>
#include <cmath>

namespace cdiff::record {

Histogram::Histogram(double low, double width, std::size_t bins)
    : low_(low), width_(width), counts_(bins, 0) {}

void Histogram::add(double value) {
  if (!std::isfinite(value)) return;
  const double last = static_cast<double>(counts_.size() - 1);
  const double bin = std::clamp(std::floor((value - low_) / width_), 0.0, last);
  ++counts_[static_cast<std::size_t>(bin)];
  statistics_.add(value);
}

double Histogram::share(std::size_t bin) const {
  return n() == 0 ? 0.0 : static_cast<double>(counts_[bin]) / static_cast<double>(n());
}

void DrivingLog::observe(const traffic::TrafficSnapshot& snapshot) {
  if (!snapshot.decision_tick) return;
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
    if (vehicle.role == traffic::VehicleRole::kEgo) continue;
    Role& role = vehicle.role == traffic::VehicleRole::kCbv ? cbv_ : background_;
    role.speed.add(vehicle.state.speed);
    role.acceleration.add(vehicle.acceleration);
  }
}

}  // namespace cdiff::record
