// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cmath>

namespace cdiff::core {

// Angles [rad]: the one place where a heading is wrapped.

constexpr double kPi = 3.14159265358979323846;
constexpr double kDegree = kPi / 180.0;  ///< [rad]

/// The angle that equals `angle` modulo 2 pi, in (-pi, pi].
inline double wrapAngle(double angle) {
  const double wrapped = std::remainder(angle, 2.0 * kPi);
  return wrapped <= -kPi ? wrapped + 2.0 * kPi : wrapped;
}

/// Signed smallest rotation that turns `from` into `to`, in (-pi, pi].
inline double angleDifference(double to, double from) { return wrapAngle(to - from); }

constexpr double degreesToRadians(double degrees) { return degrees * kPi / 180.0; }
constexpr double radiansToDegrees(double radians) { return radians * 180.0 / kPi; }

}  // namespace cdiff::core
