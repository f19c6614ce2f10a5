// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "e2e_cdiff/guidance/objective.h"

namespace cdiff::guidance {

/// J_comfort = action_weight sum_t |a_t - a_{t-1}|^2 + lateral_weight sum_t q_t^2, a = (throttle,
/// steer, brake), q_t = v_t (psi_t - psi_{t-1}) / 0.1 s = lateral acceleration [m/s^2] with psi_0 =
/// 0. Not in the paper; its smoothness and lateral terms are those usual in motion planning.
class ComfortObjective : public Objective {
 public:
  double action_weight = 1.0;   ///< weight of the squared differences of consecutive actions
  double lateral_weight = 0.1;  ///< weight of the squared lateral acceleration [s^4/m^2]

  void describe(core::OptionsVisitor& visitor) override;
  double evaluate(const GuidanceScene& scene, const traffic::Rollout& rollout,
                  traffic::Rollout& gradient) const override;
  std::unique_ptr<Objective> clone() const override;
};

}  // namespace cdiff::guidance
