// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// How often samples come in training: rare maneuvers and speeds more often than their share, so
/// that turns, starts and stops are not lost among straight driving.
#pragma once

#include <string>
#include <vector>

#include "learning/driving_sample.h"

namespace cdiff::learning {

constexpr double kStanding = 0.3;  ///< slower vehicles stand [m/s]
constexpr double kMoving = 2.0;    ///< faster ones move [m/s]

/// What is balanced: the maneuver (straight, left, right, other) and the pace (standing, starting,
/// stopping, slow below 4 m/s, middle, fast above 8 m/s), as in "left starting".
std::string balanceClass(const DrivingSample& sample);

/// Weight of each training sample, n^-balance for a class of n samples, mean 1, at most
/// kMostWeight before that: 0 leaves all alike, 1 makes every class come equally often. Those that
/// stop to give way come `yielding_share` times as often: what they wait for is seldom in the
/// image. Throws InputError if nothing is left.
std::vector<double> balanceWeights(const DrivingDataset& dataset, double balance,
                                   double yielding_share = 1.0);
constexpr double kMostWeight = 10.0;

}  // namespace cdiff::learning
