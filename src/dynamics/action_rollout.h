// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "dynamics/throttle_response.h"
#include "e2e_cdiff/dynamics/bicycle_model.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::dynamics {

// From planned actions to what a vehicle does with them; planners and data collection call it.
// A vehicle executes each value clamped to its range. The larger of throttle and brake acts, the
// other is 0; a brake below 0.05 counts as none.

/// The action that the vehicle executes in a row of a rollout.
traffic::ControlAction executableAction(const traffic::Rollout& rollout, Eigen::Index row);

/// Replaces every row's action by the one that is executed.
void makeExecutable(traffic::Rollout& rollout);

/// The exact state branch: states s_1..s_T that the vehicle dynamics gives for actions a_0..a_{T-1}
/// from (0, 0, 0, v_0) in the body frame, and its adjoint. One row is 0.1 s, two steps of
/// BicycleModel, under the action that is commanded at its start (commandedAction).
class ActionRollout {
 public:
  explicit ActionRollout(const BicycleModelOptions& options = {},
                         ThrottleResponse response = ThrottleResponse::kFitted);

  /// Fills the state columns of `rollout` from its action columns and v_0, `initial_speed` [m/s];
  /// actions out of range count as clamped to it. The heading is not wrapped.
  void rollOut(double initial_speed, traffic::Rollout& rollout) const;

  /// Adds to the action columns of `gradient` what its state columns (dJ/ds) mean for the actions:
  /// dJ/da += (ds/da)^T dJ/ds at `rollout`, whose states rollOut() made. Zero for actions at or
  /// beyond a bound that descent (along -dJ/da) points out of; beyond a bound that it points into,
  /// the derivative at the bound. Zero for throttle below 0.3, and with the monotone response below
  /// u_0(v) (the response is flat there).
  void backward(double initial_speed, const traffic::Rollout& rollout,
                traffic::Rollout& gradient) const;

  /// What is commanded at `speed` [m/s] for an action, by the response of this rollout.
  traffic::ControlAction commanded(double speed, const traffic::ControlAction& action) const {
    return commandedAction(model_, response_, speed, action);
  }

 private:
  BicycleModel model_;
  ThrottleResponse response_;
};

// The action that the vehicle dynamics needs for a motion: the inverse of BicycleModel over 0.1 s,
// for recordings that hold no pedals and for planners that choose accelerations (SI units).

/// What a vehicle did, or is to do, over 0.1 s.
struct ObservedMotion {
  double speed = 0.0;       ///< at its start [m/s]
  double next_speed = 0.0;  ///< at its end [m/s]
  double turn = 0.0;        ///< change of heading [rad], positive left
};

/// Throttle or brake, one of them 0, in steps of 0.02, whose speed after 0.1 s is nearest to
/// next_speed; steer from turn = 0.1 s v / l_r sin(slip), 0 below 0.5 m/s; all within range, so
/// that a motion beyond the model's means is approached.
traffic::ControlAction inferAction(const BicycleModel& model, const ObservedMotion& motion);

}  // namespace cdiff::dynamics
