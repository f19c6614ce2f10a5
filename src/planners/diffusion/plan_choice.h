// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Which of several sampled plans (rollouts [T, 7], body frame, SI units) is driven: the one of the
/// lowest score; or, so that a vehicle does not waver between equal ways, the one nearest to the
/// last plan while it is no worse by more than a share.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "e2e_cdiff/traffic/rollout.h"
#include "guidance/total_objective.h"

namespace cdiff::planners {

/// Index into `plans`. `previous` is the last plan as seen from here. Plans that are not finite are
/// not chosen unless none is.
std::size_t choosePlan(const std::vector<traffic::Rollout>& plans,
                       const std::vector<guidance::Score>& scores,
                       const std::optional<traffic::Rollout>& previous, double hysteresis);

}  // namespace cdiff::planners
