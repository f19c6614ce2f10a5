// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "guidance/collision_avoidance_objective.h"

namespace cdiff::guidance {

void CollisionAvoidanceObjective::describe(core::OptionsVisitor& visitor) {
  proximity.describe(visitor);
}

double CollisionAvoidanceObjective::evaluate(const GuidanceScene& scene,
                                             const traffic::Rollout& rollout,
                                             traffic::Rollout& gradient) const {
  return proximity.evaluate(scene, rollout, 1.0, gradient);
}

std::unique_ptr<Objective> CollisionAvoidanceObjective::clone() const {
  return std::make_unique<CollisionAvoidanceObjective>(*this);
}

}  // namespace cdiff::guidance
