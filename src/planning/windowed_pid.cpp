// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planning/windowed_pid.h"

#include <numeric>

namespace cdiff::planning {

WindowedPid::WindowedPid(double kp, double ki, double kd, std::int64_t window)
    : kp_(kp), ki_(ki), kd_(kd), errors_(static_cast<std::size_t>(window), 0.0) {}

double WindowedPid::update(double error) {
  const double change = error - errors_.back();
  errors_.pop_front();
  errors_.push_back(error);
  const double sum = std::accumulate(errors_.begin(), errors_.end(), 0.0);
  return kp_ * error + ki_ * sum / static_cast<double>(errors_.size()) + kd_ * change;
}

}  // namespace cdiff::planning
