// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "e2e_cdiff/guidance/objective.h"

namespace cdiff::guidance {

/// J_speed = sum_t (v_t - factor v*)^2 [m^2/s^2] over the speeds of rows 1..T, v* = target speed of
/// the scene (paper III-D1, "Speed Guidance", eq. 9 with factor 1).
class SpeedObjective : public Objective {
 public:
  double factor = 1.0;  ///< share of v* that is aimed at

  void describe(core::OptionsVisitor& visitor) override;
  double evaluate(const GuidanceScene& scene, const traffic::Rollout& rollout,
                  traffic::Rollout& gradient) const override;
  std::unique_ptr<Objective> clone() const override;
};

}  // namespace cdiff::guidance
