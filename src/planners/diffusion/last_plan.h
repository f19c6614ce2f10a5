// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <optional>

#include "dynamics/action_rollout.h"
#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::planners {

/// The plan of a vehicle's last decision, shifted to the current one (rollouts [T, 7], 0.1 s a row,
/// body frame, SI units).
class LastPlan {
 public:
  /// `plan` was made at `tick` in the frame of `start`; `route` may be nullptr.
  LastPlan(const traffic::Rollout& plan, std::uint64_t tick, const traffic::VehicleState& start,
           const map::Route* route);

  std::uint64_t tick() const { return tick_; }
  /// The plan without its first `rows` rows, the last action or `tail` held, as the exact dynamics
  /// drives it from `now`. nullopt unless `rows` is a whole number from 1 to T.
  std::optional<traffic::Rollout> continued(
      double rows, const dynamics::ActionRollout& dynamics, const traffic::VehicleState& now,
      const std::optional<traffic::ControlAction>& tail = std::nullopt) const;
  /// Whether the vehicle is where the plan said after `rows` rows (0.5 m, 0.1 rad, 0.5 m/s) and its
  /// route still ends at the same place.
  bool holds(Eigen::Index rows, const traffic::VehicleState& now, const map::Route* route) const;

 private:
  traffic::Rollout plan_;
  std::uint64_t tick_ = 0;
  traffic::VehicleState start_;
  std::optional<Eigen::Vector2d> goal_;
};

}  // namespace cdiff::planners
