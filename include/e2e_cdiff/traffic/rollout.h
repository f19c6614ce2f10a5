// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>

namespace cdiff::traffic {

// A rollout tau = [states; actions] as a matrix of T rows x 7 columns (SI units, body frame of the
// vehicle at planning time): row t pairs the action a_t with the state s_{t+1} that it leads to
// (paper III-C1).

/// Columns of a rollout; states first.
enum RolloutColumn : int {
  kRolloutX = 0,         ///< [m]
  kRolloutY = 1,         ///< [m]
  kRolloutHeading = 2,   ///< [rad], not wrapped
  kRolloutSpeed = 3,     ///< [m/s]
  kRolloutThrottle = 4,  ///< [0, 1]
  kRolloutSteer = 5,     ///< [-1, 1], positive left
  kRolloutBrake = 6,     ///< [0, 1]
};
inline constexpr int kStateColumns = 4;
inline constexpr int kActionColumns = 3;
inline constexpr int kRolloutColumns = kStateColumns + kActionColumns;
/// Time from one row to the next [s].
inline constexpr double kRolloutStep = 0.1;

/// A rollout [T, 7] in metric units, by the columns above.
using Rollout = Eigen::Matrix<double, Eigen::Dynamic, kRolloutColumns, Eigen::RowMajor>;

}  // namespace cdiff::traffic
