// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Own mean speed over the background traffic's [%] on equal stretches of the ego route, as CARLA's
/// MinimumSpeedRouteTest has it: 100 x mean over ticks of the ego's speed / mean over the same
/// ticks of the mean speed of all background vehicles.
#pragma once

#include <cstddef>
#include <vector>

#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::metrics {

class MinimumSpeed {
 public:
  /// A route of `length` [m] in `checkpoints` stretches; 0: none.
  MinimumSpeed(double length, std::size_t checkpoints);

  /// One tick, with the ego `arc_length` [m] along its route. Ticks without background vehicles do
  /// not enter.
  void observe(double arc_length, double ego_speed, const traffic::TrafficSnapshot& snapshot);
  /// Of each stretch that was driven to its end, the last one from 95 % of the route on; a stretch
  /// without moving background vehicles is left out [%].
  std::vector<double> percents() const;

 private:
  struct Stretch {
    double ego = 0.0;         ///< sum of speeds over ticks
    double background = 0.0;  ///< sum of mean speeds over the same ticks
  };
  double length_;
  std::size_t checkpoints_;
  std::size_t passed_ = 0;
  double arc_length_ = 0.0;
  Stretch open_;
  std::vector<double> percents_;
};

}  // namespace cdiff::metrics
