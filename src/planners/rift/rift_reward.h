// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <cstddef>

namespace cdiff::planners {

inline constexpr std::size_t kRiftSteps = 40;  ///< of a rollout, 0.1 s each
inline constexpr double kRiftDiscount = 0.98;  ///< per step

/// What is rewarded of a rollout's step (SI units).
struct RiftStep {
  double speed = 0.0;
  double acceleration = 0.0;
  double yaw_acceleration = 0.0;  ///< [rad/s^2]
  double offset = 0.0;            ///< d: of the planned place from the reference line [m]
  double heading_error = 0.0;     ///< D: of the planned heading from the line's, in [-pi, pi] [rad]
  bool collides = false;
  bool off_road = false;
};

/// RIFT's reward of a state (Chen et al. 2025; docs/rift.md):
/// r = -(20 + |v|) [collides] - 5 [off road] - 0.8 ([|a| > 4] + [|yaw acceleration| > 4])
///     + 0.5 (min(cos D, 0) + 0.05 min(v cos D, 0) + 0.25 (1 - |D| / (pi / 2)))
///     - 0.6 [cos D > 0.5] (|d| - 0.05 / exp(|d| - 0.5))
///     + 0.1 max(cos D, 0) [3 < |v| < 20] |v| - 0.1 [|v| > 0 or |a| > 0].
double riftReward(const RiftStep& step);

/// A rollout's numbers at 0, 0.1, ... 4 s.
using RiftSeries = std::array<double, kRiftSteps + 1>;

/// Quadratics fitted to five neighbors (Savitzky and Golay 1964); at the ends, the fit of the first
/// and the last five.
RiftSeries smoothed(const RiftSeries& values);
/// Central differences over 0.1 s, one-sided at the ends.
RiftSeries rateOf(const RiftSeries& values);

/// Sum over steps of 0.98^i r_i, i from 0, up to and with the first collision.
double riftReturn(const std::array<RiftStep, kRiftSteps>& steps);

}  // namespace cdiff::planners
