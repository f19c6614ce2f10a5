// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/guidance/objective.h"

namespace cdiff::guidance {

/// J_yield = sum_t max(0, s_t - L_t)^2 [m^2], s_t the arc length of row t on the vehicle's route and
/// L_t the farthest at which its box does not meet the forecast box of a vehicle that it gives way
/// to. Not in the paper, whose collision guidance is about the ego alone.
///
/// The route is what the vehicle will sweep, at its present lateral offset. Another vehicle is given
/// way to where its forecast box, with a gap, first enters that strip ahead of the vehicle at row
/// t_in, unless the vehicle, accelerating gently to its target speed, has cleared the part that the
/// other sweeps `margin` before then. Its limits hold `margin` before and after each row. Vehicles
/// ahead in the lane are those of traffic_avoidance.
class YieldingObjective : public Objective {
 public:
  double longitudinal_gap = 1.0;  ///< between bumpers [m]
  double lateral_gap = 0.3;       ///< between sides [m]
  double margin = 0.5;            ///< in time, before and after the other [s]

  void describe(core::OptionsVisitor& visitor) override;
  /// Finds the limits of this decision.
  void prepare(const GuidanceScene& scene) override;
  double evaluate(const GuidanceScene& scene, const traffic::Rollout& rollout,
                  traffic::Rollout& gradient) const override;
  std::unique_ptr<Objective> clone() const override;

 private:
  std::vector<double> limits_;  ///< L_t, infinite where the way is free; empty: everywhere
};

}  // namespace cdiff::guidance
