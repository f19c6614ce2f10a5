// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <deque>

namespace cdiff::planning {

/// PID with the mean of the last errors instead of an integral: kp e + ki mean(window) + kd (e - e
/// before). One call per decision; the gains are per call, so they depend on the decision period.
class WindowedPid {
 public:
  /// `window`: errors in the mean, zeros at the start.
  WindowedPid(double kp, double ki, double kd, std::int64_t window);
  /// Output for this error; remembers it.
  double update(double error);

 private:
  double kp_;
  double ki_;
  double kd_;
  std::deque<double> errors_;  ///< newest last, of fixed length
};

}  // namespace cdiff::planning
