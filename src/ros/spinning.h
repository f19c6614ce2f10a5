// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Wall-clock helpers of the traffic simulator's single thread.
#pragma once

#include <chrono>

#include "ros/callback_queue.h"
#include "ros/ros.h"

namespace cdiff::ros {

/// [s] of wall time between looks at signals and limits.
constexpr double kSpinPeriod = 0.05;

inline double secondsSince(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Calls what has come; waits at most `seconds` for it.
inline void spin(double seconds) {
  ::ros::getGlobalCallbackQueue()->callAvailable(::ros::WallDuration(seconds));
}

}  // namespace cdiff::ros
