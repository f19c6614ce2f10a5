// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "realism/recording.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "e2e_cdiff/core/angle.h"

namespace cdiff::realism {
namespace {

constexpr double kMovingSpeed = 1.0;     // above it, motion has a direction [m/s]
constexpr double kStandingSpeed = 0.02;  // up to it, noise [m/s]

/// Half of the difference of the neighbors.
template <class Difference>
Series centralDifference(const Series& values, Difference difference) {
  Series result(values.size(), kNoValue);
  for (std::size_t i = 1; i + 1 < values.size(); ++i)
    result[i] = difference(values[i - 1], values[i + 1]) / 2.0;
  return result;
}

double plainDifference(double before, double after) { return after - before; }

double wrapped(double before, double after) { return core::angleDifference(after, before); }

void divide(Series& values, double divisor) {
  for (double& value : values) value /= divisor;
}

Series coordinate(const Track& track, int axis) {
  Series values;
  for (const TrackState& state : track.states) values.push_back(state.position[axis]);
  return values;
}

/// Headings without jumps.
Series unwrappedHeadings(const Track& track) {
  Series values;
  for (const TrackState& state : track.states) {
    const double before = values.empty() ? state.heading : values.back();
    values.push_back(before + core::angleDifference(state.heading, before));
  }
  return values;
}

/// Headings of motion where there is motion; elsewhere those of the nearest moving state.
void followMotion(const Series& vx, const Series& vy, const Series& speed, Track& track) {
  std::vector<std::size_t> moving;
  for (std::size_t i = 0; i < speed.size(); ++i) {
    if (speed[i] > kMovingSpeed) moving.push_back(i);
  }
  if (moving.empty()) return;
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < speed.size(); ++i) {
    const auto away = [&](std::size_t k) { return moving[k] > i ? moving[k] - i : i - moving[k]; };
    while (nearest + 1 < moving.size() && away(nearest + 1) < away(nearest)) ++nearest;
    track.states[i].heading = std::atan2(vy[moving[nearest]], vx[moving[nearest]]);
  }
}

}  // namespace

geometry::OrientedBox Track::box(std::size_t step) const {
  const TrackState& state = at(step);
  return {state.position, state.heading, length, width};
}

Motion centralMotion(const Track& track) {
  const Series dx = centralDifference(coordinate(track, 0), plainDifference);
  const Series dy = centralDifference(coordinate(track, 1), plainDifference);
  Motion motion;
  for (std::size_t i = 0; i < dx.size(); ++i)
    motion.speed.push_back(std::hypot(dx[i], dy[i]) / kStep);
  motion.acceleration = centralDifference(motion.speed, plainDifference);
  divide(motion.acceleration, kStep);
  Series headings;
  for (const TrackState& state : track.states) headings.push_back(state.heading);
  motion.yaw_rate = centralDifference(headings, wrapped);
  motion.yaw_acceleration = centralDifference(motion.yaw_rate, plainDifference);
  divide(motion.yaw_rate, kStep);
  divide(motion.yaw_acceleration, kStep * kStep);
  return motion;
}

Series smoothedDerivative(const Series& values) {
  // Least squares of a + b k + c k^2 over k = -5..5: b = sum k x_k / 110, c = sum (k^2 - 10) x_k /
  // 858; the derivative at k is b + 2 c k.
  constexpr std::ptrdiff_t kHalf = kSmoothingWindow / 2;
  const auto count = static_cast<std::ptrdiff_t>(values.size());
  if (count < 2 * kHalf + 1) return {};
  Series result;
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const std::ptrdiff_t center = std::clamp(i, kHalf, count - 1 - kHalf);
    double slope = 0.0;
    double curvature = 0.0;
    for (std::ptrdiff_t k = -kHalf; k <= kHalf; ++k) {
      const double value = values[static_cast<std::size_t>(center + k)];
      slope += static_cast<double>(k) * value / 110.0;
      curvature += static_cast<double>(k * k - 10) * value / 858.0;
    }
    result.push_back((slope + 2.0 * curvature * static_cast<double>(i - center)) / kStep);
  }
  return result;
}

Motion smoothedMotion(Track& track) {
  const Series none(track.states.size(), kNoValue);
  if (track.states.size() < kSmoothingWindow) return {none, none, none, none};
  const Series vx = smoothedDerivative(coordinate(track, 0));
  const Series vy = smoothedDerivative(coordinate(track, 1));
  Motion motion;
  for (std::size_t i = 0; i < vx.size(); ++i) {
    const double speed = std::hypot(vx[i], vy[i]);
    motion.speed.push_back(speed <= kStandingSpeed ? 0.0 : speed);
  }
  motion.acceleration = smoothedDerivative(motion.speed);
  followMotion(vx, vy, motion.speed, track);
  motion.yaw_rate = smoothedDerivative(unwrappedHeadings(track));
  motion.yaw_acceleration = smoothedDerivative(motion.yaw_rate);
  return motion;
}

}  // namespace cdiff::realism
