// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/map/route_progress.h"

#include <algorithm>

namespace cdiff::map {

RouteProgress::RouteProgress(const Route& route, double completion_percent,
                             double completion_distance)
    : route_(&route),
      completion_percent_(completion_percent),
      completion_distance_(completion_distance),
      distance_to_end_(route.length()) {}

void RouteProgress::update(const Eigen::Vector2d& position) {
  constexpr double kWindowAhead = 15.0;
  constexpr double kWindowBehind = 5.0;
  const auto near = route_->path().project(position, std::max(0.0, arc_length_ - kWindowBehind),
                                           std::min(route_->length(), arc_length_ + kWindowAhead));
  arc_length_ = std::max(arc_length_, near.arc_length);
  deviation_ = near.distance;
  distance_to_end_ = (position - route_->path().points().back().head<2>()).norm();
}

double RouteProgress::percent() const {
  const double percent = 100.0 * arc_length_ / route_->length();
  const bool complete = percent >= completion_percent_ && distance_to_end_ <= completion_distance_;
  return complete ? 100.0 : std::min(percent, 100.0);
}

}  // namespace cdiff::map
