// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What a vehicle executes of a denoised action: each value clamped to its range; of throttle and
/// brake the larger acts, the other is 0; a brake below 0.05 counts as none.
#pragma once

#include "e2e_cdiff/traffic/rollout.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::dynamics {

/// Of a row of a rollout.
traffic::ControlAction executableAction(const traffic::Rollout& rollout, Eigen::Index row);

/// Replaces every row's action by the one that is executed.
void makeExecutable(traffic::Rollout& rollout);

}  // namespace cdiff::dynamics
