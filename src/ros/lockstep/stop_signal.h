// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <chrono>

#include "ros/callback_queue.h"
#include "ros/ros.h"

namespace cdiff::ros {

/// SIGINT, SIGTERM and SIGHUP without a handler: they are blocked from here on, in every thread
/// made later, and asked for when it suits. So a session can end in order, whatever it is doing.
class StopSignal {
 public:
  /// Make it before any other thread exists, hence before ros::init.
  StopSignal();
  /// Whether one of them has arrived, now or before.
  bool raised();

 private:
  bool raised_ = false;
};

// Wall-clock helpers of the traffic simulator's single thread.

/// [s] of wall time between looks at signals and limits.
constexpr double kSpinPeriod = 0.05;

inline double secondsSince(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Handles what has arrived; waits at most `seconds` for it.
inline void spin(double seconds) {
  ::ros::getGlobalCallbackQueue()->callAvailable(::ros::WallDuration(seconds));
}

}  // namespace cdiff::ros
