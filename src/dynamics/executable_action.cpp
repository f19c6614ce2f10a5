// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "dynamics/executable_action.h"

#include <algorithm>

namespace cdiff::dynamics {
namespace {

constexpr double kLeastBrake = 0.05;  // below it the sampled brake is noise around none

}  // namespace

traffic::ControlAction executableAction(const traffic::Rollout& rollout, Eigen::Index row) {
  traffic::ControlAction action;
  action.throttle = std::clamp(rollout(row, traffic::kRolloutThrottle), 0.0, 1.0);
  action.steer = std::clamp(rollout(row, traffic::kRolloutSteer), -1.0, 1.0);
  action.brake = std::clamp(rollout(row, traffic::kRolloutBrake), 0.0, 1.0);
  if (action.brake < kLeastBrake || action.brake < action.throttle)
    action.brake = 0.0;
  else
    action.throttle = 0.0;
  return action;
}

void makeExecutable(traffic::Rollout& rollout) {
  for (Eigen::Index row = 0; row < rollout.rows(); ++row) {
    const traffic::ControlAction action = executableAction(rollout, row);
    rollout.row(row).tail<traffic::kActionColumns>() << action.throttle, action.steer, action.brake;
  }
}

}  // namespace cdiff::dynamics
