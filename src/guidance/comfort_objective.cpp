// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "guidance/comfort_objective.h"

namespace cdiff::guidance {

void ComfortObjective::describe(core::OptionsVisitor& visitor) {
  visitor.number({"action_weight", "", "Weight of squared differences of consecutive actions."},
                 action_weight, 0.0, 1000.0);
  visitor.number({"lateral_weight", "s^4/m^2", "Weight of the squared lateral acceleration."},
                 lateral_weight, 0.0, 1000.0);
}

double ComfortObjective::evaluate(const GuidanceScene&, const traffic::Rollout& rollout,
                                  traffic::Rollout& gradient) const {
  constexpr int kActions = traffic::kActionColumns;
  double sum = 0.0;
  for (Eigen::Index row = 0; row < rollout.rows(); ++row) {
    const double before = row == 0 ? 0.0 : rollout(row - 1, traffic::kRolloutHeading);
    const double turned = rollout(row, traffic::kRolloutHeading) - before;
    const double speed = rollout(row, traffic::kRolloutSpeed);
    const double lateral = speed * turned / traffic::kRolloutStep;
    const double by_lateral = 2.0 * lateral_weight * lateral / traffic::kRolloutStep;
    sum += lateral_weight * lateral * lateral;
    gradient(row, traffic::kRolloutSpeed) += by_lateral * turned;
    gradient(row, traffic::kRolloutHeading) += by_lateral * speed;
    if (row == 0) continue;
    gradient(row - 1, traffic::kRolloutHeading) -= by_lateral * speed;
    const Eigen::Matrix<double, 1, kActions> change =
        rollout.row(row).tail<kActions>() - rollout.row(row - 1).tail<kActions>();
    sum += action_weight * change.squaredNorm();
    gradient.row(row).tail<kActions>() += 2.0 * action_weight * change;
    gradient.row(row - 1).tail<kActions>() -= 2.0 * action_weight * change;
  }
  return sum;
}

std::unique_ptr<Objective> ComfortObjective::clone() const {
  return std::make_unique<ComfortObjective>(*this);
}

}  // namespace cdiff::guidance
