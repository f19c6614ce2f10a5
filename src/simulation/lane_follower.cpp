// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "simulation/lane_follower.h"

#include <algorithm>
#include <limits>

#include "e2e_cdiff/core/angle.h"

namespace cdiff::simulation {

namespace {

constexpr double kLookAhead = 12.0;  ///< farther than a vehicle drives in a step [m]
constexpr double kPreference = 0.4;  ///< of the lanes ahead over nearer ones [m]
constexpr double kSameDirection = 0.5 * core::kPi;

struct Candidate {
  LaneTarget target;
  double distance = std::numeric_limits<double>::infinity();
};

/// The best place on the lanes that `from` leads to.
Candidate alongLanes(const EdgeGraph& graph, const Eigen::Vector2d& front, double heading,
                     const std::vector<int>& way, const LanePlace& from) {
  Candidate best;
  double begin = -from.arc_length;  // of the lane, seen from `from`
  map::LaneIndex lane = from.lane;
  while (lane != map::kNoLane && begin < kLookAhead) {
    const geometry::Polyline& line = graph.network().lane(lane).centerline;
    const geometry::Projection here = line.project(front);
    const bool same = std::abs(core::angleDifference(here.heading, heading)) < kSameDirection;
    if (same && here.distance < best.distance - 1e-9) {
      best = {{{lane, here.arc_length}, begin + here.arc_length}, here.distance};
    }
    begin += line.length();
    lane = graph.nextLane(lane, way);
  }
  return best;
}

}  // namespace

std::optional<LaneTarget> laneTarget(const EdgeGraph& graph, const FrontPlace& front,
                                     double heading, const std::vector<int>& way,
                                     const LanePlace& from) {
  Candidate best;
  if (from.lane != map::kNoLane) best = alongLanes(graph, front.position, heading, way, from);
  const double limit = best.distance - kPreference;
  for (const map::LaneMatch& match : front.lanes) {
    if (std::abs(match.heading_difference) >= kSameDirection || !graph.onWay(match.lane, way))
      continue;
    if (match.projection.distance >= std::min(limit, best.distance)) continue;
    best = {{{match.lane, match.projection.arc_length}, std::nullopt}, match.projection.distance};
  }
  if (best.target.place.lane == map::kNoLane) return std::nullopt;
  return best.target;
}

}  // namespace cdiff::simulation
