// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/guidance/objective.h"

namespace cdiff::guidance {

/// J_traffic = sum_t sum_i w(b) max(0, a + A)^2 [m^2] over vehicles i ahead in the lane, and A^2
/// max(0, 1 - rho)^2, rho^2 = (a / A)^2 + (b / B)^2, over all others: a and b are the planned place
/// along and across vehicle i as predicted for row t, A and B half of both boxes' lengths and
/// widths plus a gap, w(b) = max(0, 1 - (b / B)^2)^2. Not in the paper, whose collision guidance is
/// about the ego alone.
///
/// A vehicle is ahead in the lane when the planned one now stands behind its center, beside its
/// line by less than B, and heads in the same direction within 60 degrees. The term of these grows
/// without end, so that a plan through a leader is drawn back behind it, not on past it.
class TrafficAvoidanceObjective : public Objective {
 public:
  double longitudinal_gap = 4.0;  ///< between bumpers [m]
  double lateral_gap = 0.8;       ///< between sides [m]

  void describe(core::OptionsVisitor& visitor) override;
  double evaluate(const GuidanceScene& scene, const traffic::Rollout& rollout,
                  traffic::Rollout& gradient) const override;
  std::unique_ptr<Objective> clone() const override;
};

}  // namespace cdiff::guidance
