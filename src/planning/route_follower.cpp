// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planning/route_follower.h"

#include <algorithm>

namespace cdiff::planning {
namespace {

/// Signed distance past the end of the route along its last heading [m].
double beyondEnd(const map::Route& route, const Eigen::Vector2d& position) {
  const Eigen::Vector2d forward = geometry::direction(route.path().headingAt(route.length()));
  return forward.dot(position - route.path().positionAt(route.length()));
}

/// Signed distance before the start of the route against its first heading [m].
double beforeStart(const map::Route& route, const Eigen::Vector2d& position) {
  const Eigen::Vector2d forward = geometry::direction(route.path().headingAt(0.0));
  return forward.dot(route.path().positionAt(0.0) - position);
}

}  // namespace

double extendedProjection(const map::Route& route, const Eigen::Vector2d& position, double begin,
                          double end) {
  const double length = route.length();
  const double low = std::clamp(begin, 0.0, length);
  const double high = std::clamp(end, low, length);
  const double inside = route.path().project(position, low, high).arc_length;
  if (inside >= length && end > length) {
    return std::clamp(length + std::max(0.0, beyondEnd(route, position)), begin, end);
  }
  if (inside <= 0.0 && begin < 0.0) {
    return std::clamp(-std::max(0.0, beforeStart(route, position)), begin, end);
  }
  return inside;
}

bool RouteFollower::knows(const map::Route& route) const {
  const auto& points = route.path().points();
  return points.size() == point_count_ && route.length() == length_ && points.front() == first_ &&
         points.back() == last_;
}

void RouteFollower::start(const map::Route& route, const Eigen::Vector2d& position) {
  constexpr double kStartStretch = 20.0;
  constexpr double kStartDistance = 3.0;
  const auto& points = route.path().points();
  point_count_ = points.size();
  length_ = route.length();
  first_ = points.front();
  last_ = points.back();
  const double stretch = std::min(kStartStretch, length_);
  const geometry::Projection near = route.path().project(position, 0.0, stretch);
  const bool at_start = near.distance <= kStartDistance;
  arc_length_ = at_start ? near.arc_length : route.path().project(position).arc_length;
}

void RouteFollower::update(const map::Route& route, const Eigen::Vector2d& position, double reach) {
  if (!knows(route)) start(route, position);
  const double ahead = std::max(map::kRouteWindow.ahead, reach);
  const double found = extendedProjection(route, position, arc_length_ - map::kRouteWindow.behind,
                                          arc_length_ + ahead);
  arc_length_ = std::max(arc_length_, found);
}

void EgoFollower::update(const map::Route& route, const traffic::TrafficSnapshot& snapshot,
                         double simulation_step) {
  constexpr double kFastest = 40.0;  // [m/s]
  const auto skipped = static_cast<double>(snapshot.tick - std::min(snapshot.tick, tick_));
  tick_ = snapshot.tick;
  follower_.update(route, snapshot.ego()->state.position, kFastest * skipped * simulation_step);
}

}  // namespace cdiff::planning
