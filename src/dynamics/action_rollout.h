// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The exact state branch: states s_1..s_T that the vehicle dynamics gives for actions a_0..a_{T-1}
/// from (0, 0, 0, v_0) in the body frame, and its adjoint. One row is 0.1 s, two steps of
/// BicycleModel.
#pragma once

#include "e2e_cdiff/dynamics/bicycle_model.h"
#include "e2e_cdiff/traffic/rollout.h"

namespace cdiff::dynamics {

class ActionRollout {
 public:
  explicit ActionRollout(const BicycleModelOptions& options = {});

  /// Fills the state columns of `rollout` from its action columns; actions out of range count as
  /// clamped to it. The heading is not wrapped.
  void rollOut(double initial_speed, traffic::Rollout& rollout) const;

  /// Adds to the action columns of `gradient` what its state columns (dJ/ds) mean for the actions:
  /// dJ/da += (ds/da)^T dJ/ds at `rollout`, whose states rollOut() made. Zero for actions at or
  /// beyond a bound that descent (along -dJ/da) points out of; beyond a bound that it points into,
  /// the derivative at the bound. Zero for throttle below 0.3 (the response is flat there).
  void pullBack(double initial_speed, const traffic::Rollout& rollout,
                traffic::Rollout& gradient) const;

 private:
  BicycleModel model_;
};

}  // namespace cdiff::dynamics
