// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "collection/random_route.h"

#include <algorithm>

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::collection {
namespace {

using map::LaneIndex;

constexpr std::uint32_t kFirstElement = 64;
constexpr double kLaneChangeRoom = 60.0;  // [m]

/// Draws lane after lane.
class RandomWalk {
 public:
  RandomWalk(const map::RoadNetwork& network, const core::RandomStream& random,
             const core::RandomKey& key)
      : network_(network), random_(random), key_(key) {}

  /// Lanes from `start` on, at least `length` beyond `begin` of it where the network allows; the
  /// length in `length` afterwards.
  map::LanePath walk(LaneIndex start, double begin, double& length, double lane_change_share) {
    map::LanePath path;
    path.lanes.push_back(start);
    double end = lengthOf(start) - begin;
    while (end < length || network_.lane(path.lanes.back()).internal) {
      changeLane(path, lane_change_share);
      const LaneIndex next = follower(path.lanes.back());
      if (next == map::kNoLane) break;
      path.lanes.push_back(next);
      end += lengthOf(next);
    }
    length = end;
    path.length = end;
    return path;
  }

 private:
  double lengthOf(LaneIndex lane) const { return network_.lane(lane).centerline.length(); }

  std::vector<LaneIndex> followers(LaneIndex lane) const {
    std::vector<LaneIndex> lanes;
    for (const map::LaneLink& link : network_.lane(lane).next) {
      const bool back = link.direction == 't';
      if (!back && network_.lane(link.to).routable) lanes.push_back(link.to);
    }
    return lanes;
  }

  LaneIndex follower(LaneIndex lane) {
    const std::vector<LaneIndex> lanes = followers(lane);
    if (lanes.empty()) return map::kNoLane;
    return lanes[random_.index(key_, element_++, lanes.size())];
  }

  /// To a neighbor where the lane ends, or now and then on a long one.
  void changeLane(map::LanePath& path, double share) {
    const map::Lane& lane = network_.lane(path.lanes.back());
    const bool first = path.lanes.size() == 1;
    const bool long_enough = !lane.internal && !first && lane.centerline.length() > kLaneChangeRoom;
    const bool wished = long_enough && random_.uniform(key_, element_++) < share;
    const bool ends = followers(path.lanes.back()).empty();
    if (!wished && !ends) return;
    std::vector<LaneIndex> beside;
    for (const LaneIndex neighbour : {lane.right, lane.left}) {
      if (neighbour == map::kNoLane || !network_.lane(neighbour).routable) continue;
      if (!followers(neighbour).empty()) beside.push_back(neighbour);
    }
    if (beside.empty()) return;
    path.lanes.push_back(beside[random_.index(key_, element_++, beside.size())]);
  }

  const map::RoadNetwork& network_;
  const core::RandomStream& random_;
  core::RandomKey key_;
  std::uint32_t element_ = kFirstElement;
};

}  // namespace

std::optional<map::Route> randomRoute(const map::LaneGraph& graph, const map::LanePosition& start,
                                      const RandomRouteOptions& options,
                                      const core::RandomStream& random,
                                      const core::RandomKey& key) {
  constexpr double kLeastLastLane = 2.0;  // [m]
  double length = options.length;
  const map::LanePath path =
      RandomWalk(graph.network(), random, key)
          .walk(start.lane, start.arc_length, length, options.lane_change_share);
  if (length < options.minimum_length) return std::nullopt;
  const map::Lane& last = graph.network().lane(path.lanes.back());
  if (last.internal) return std::nullopt;
  const double surplus = std::max(0.0, length - options.length);
  const double last_length = last.centerline.length();
  const double begin = path.lanes.size() == 1 ? start.arc_length : 0.0;
  const double goal =
      std::max(std::min(begin + kLeastLastLane, last_length), last_length - surplus);
  const map::Route route = graph.toRoute(path, start.arc_length, goal);
  if (route.length() < options.minimum_length) return std::nullopt;
  return route;
}

map::Route extendedAtRandom(const map::LaneGraph& graph, const map::Route& route, double length,
                            const core::RandomStream& random) {
  constexpr double kWorthIt = 20.0;  // [m]
  const double missing = length - route.length();
  if (missing < kWorthIt) return route;
  const Eigen::Vector3d end = route.path().points().back();
  const LaneIndex lane = route.lanes().back();
  const double begin = graph.network().lane(lane).centerline.project(end.head<2>()).arc_length;
  const RandomRouteOptions options{kWorthIt, missing, 0.0};
  const auto rest = randomRoute(graph, {lane, begin}, options, random, {});
  if (!rest) return route;
  std::vector<Eigen::Vector3d> points = route.path().points();
  std::vector<LaneIndex> lanes = route.lanes();
  for (std::size_t i = 1; i < rest->lanes().size(); ++i) {
    points.push_back(rest->path().points()[i]);
    lanes.push_back(rest->lanes()[i]);
  }
  return map::Route(graph.network(), points, lanes);
}

}  // namespace cdiff::collection
