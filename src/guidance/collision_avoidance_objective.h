// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/guidance/objective.h"
#include "guidance/proximity.h"

namespace cdiff::guidance {

/// J_coll = sum_t softplus((d_safe - d_t) / kappa) + lambda exp(-d_t^2 / (2 sigma^2)), see
/// Proximity (paper III-D1, eq. 11, J_coll^safe): keeps away from the other vehicle.
class CollisionAvoidanceObjective : public Objective {
 public:
  Proximity proximity;

  void describe(core::OptionsVisitor& visitor) override;
  double evaluate(const GuidanceScene& scene, const traffic::Rollout& rollout,
                  traffic::Rollout& gradient) const override;
  std::unique_ptr<Objective> clone() const override;
};

}  // namespace cdiff::guidance
