// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "guidance/speed_objective.h"

namespace cdiff::guidance {

void SpeedObjective::describe(core::OptionsVisitor& visitor) {
  visitor.number({"factor", "", "Share of the target speed v* that is aimed at."}, factor, 0.0,
                 3.0);
}

double SpeedObjective::evaluate(const GuidanceScene& scene, const traffic::Rollout& rollout,
                                traffic::Rollout& gradient) const {
  const double target = factor * scene.target_speed;
  double sum = 0.0;
  for (Eigen::Index row = 0; row < rollout.rows(); ++row) {
    const double excess = rollout(row, traffic::kRolloutSpeed) - target;
    sum += excess * excess;
    gradient(row, traffic::kRolloutSpeed) += 2.0 * excess;
  }
  return sum;
}

std::unique_ptr<Objective> SpeedObjective::clone() const {
  return std::make_unique<SpeedObjective>(*this);
}

}  // namespace cdiff::guidance
