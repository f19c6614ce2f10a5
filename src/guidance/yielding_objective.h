// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/guidance/objective.h"

namespace cdiff::guidance {

/// J_yield = sum_t max(0, s_t - L_t)^2 [m^2]: s_t is the arc length of row t on the vehicle's
/// route, straight on beyond its end, and L_t the first place on it at which the vehicle's box,
/// with the gaps, would meet the box that another vehicle to give way to is forecast to have at row
/// t, or within `margin` of it. Longitudinal alone. Not in the paper, whose collision guidance is
/// about the ego alone.
///
/// The vehicle keeps its present lateral offset to the route. One that enters its way at row t_in
/// is given way to, unless
///  - both are driven by the same rules and it does not go first (RightOfWay);
///  - the planned vehicle has driven through all that the other will sweep `margin` before t_in,
///    accelerating gently to its target speed;
///  - it meets the vehicle where that is now, and is neither ahead by its center nor passes with a
///    part of it ahead of the front bumper.
/// The last two are asked where the other goes by rules of its own.
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
  std::vector<double>
      limits_;  ///< L_t, infinite where the way is free [m]; empty: it is everywhere
};

}  // namespace cdiff::guidance
