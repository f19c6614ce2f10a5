// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/driving_log.h"

namespace cdiff::record {

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
