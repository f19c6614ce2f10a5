// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Interaction score of a candidate at one point of the ego's route, in [0, 1]:
/// exp(-ds^2 / 2 sigma_s^2) exp(-dT^2 / 2 sigma_T^2) exp(-d / l), with ds the difference of the
/// distances still to drive [m], dT that of the arrival times at present speeds (at least v_min)
/// [s], and d the distance from candidate to ego [m].
#pragma once

#include "cbv/cbv_options.h"
#include "e2e_cdiff/cbv/cbv_selection.h"

namespace cdiff::cbv {

/// Time to drive `distance` [m] at `speed` [m/s], taken as at least `minimum_speed`.
double arrivalTime(double distance, double speed, double minimum_speed);

/// Score of a conflict point for a candidate `separation` metres away from the ego.
double interactionScore(const ConflictPoint& point, double separation, const CbvOptions& options);

}  // namespace cdiff::cbv
