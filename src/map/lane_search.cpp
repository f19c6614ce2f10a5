// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "map/lane_search.h"

#include <algorithm>
#include <functional>

namespace cdiff::map {
namespace {

constexpr double kTolerance = 0.5;  // [m] "abreast" is only as exact as that where lanes bend

}  // namespace

double laneChangePenalty(const Lane& lane, double available) {
  constexpr double kPenalty = 5.0;
  constexpr double kComfortableLength = 25.0;
  constexpr double kPerMissingMeter = 0.5;
  constexpr double kInsideJunction = 20.0;
  const double missing = std::max(0.0, kComfortableLength - available);
  return kPenalty + kPerMissingMeter * missing + (lane.internal ? kInsideJunction : 0.0);
}

double arcLengthAbreast(const RoadNetwork& network, LaneIndex from, double arc_length,
                        LaneIndex to) {
  constexpr double kWindow =
      40.0;  // [m] lanes of one edge differ by less between two abreast points
  const geometry::Polyline& line = network.lane(from).centerline;
  const geometry::Polyline& beside = network.lane(to).centerline;
  const double guess = arc_length / line.length() * beside.length();
  const double begin = std::clamp(guess - kWindow, 0.0, beside.length());
  const double end = std::clamp(guess + kWindow, 0.0, beside.length());
  return beside.project(line.positionAt(arc_length), begin, end).arc_length;
}

bool turnsRound(const Lane& from, const LaneLink& link) {
  return link.direction == 't' && !from.internal;
}

LaneSearch::LaneSearch(const RoadNetwork& network, const LanePosition& start,
                       const SearchLimits& limits)
    : network_(network),
      start_(start),
      limits_(limits),
      rank_(2 * network.lanes().size(), kInfinity),
      driven_(2 * network.lanes().size(), kInfinity),
      parent_(2 * network.lanes().size(), -1) {
  run();
}

void LaneSearch::run() {
  const std::size_t first = count() + static_cast<std::size_t>(start_.lane);
  rank_[first] = 0.0;
  driven_[first] = -start_.arc_length;
  queue_.emplace_back(0.0, first);
  while (!queue_.empty()) {
    std::pop_heap(queue_.begin(), queue_.end(), std::greater<>());
    const auto [rank, node] = queue_.back();
    queue_.pop_back();
    if (rank == rank_[node]) expand(node);
  }
}

void LaneSearch::expand(std::size_t node) {
  const LaneIndex index = laneOf(node);
  const Lane& lane = network_.lane(index);
  if (limits_.routable_only && !lane.routable && index != start_.lane) return;
  const double length = lane.centerline.length();
  const double remaining = node < count() ? length : std::max(0.0, length + driven_[node]);
  for (const LaneLink& next : lane.next) {
    if (!network_.lane(next.to).allows_cars) continue;
    if (limits_.turn_rounds != nullptr && turnsRound(lane, next) &&
        limits_.turn_rounds->count({index, next.to}) == 0)
      continue;
    relax(static_cast<std::size_t>(next.to), node, rank_[node] + remaining, driven_[node] + length);
  }
  if (!limits_.lane_changes) return;
  relaxNeighbor(node, lane.left);
  relaxNeighbor(node, lane.right);
}

void LaneSearch::relaxNeighbor(std::size_t node, LaneIndex neighbor) {
  if (neighbor == kNoLane) return;
  const Lane& from = network_.lane(laneOf(node));
  const double length = from.centerline.length();
  const double available = node < count() ? length : length + driven_[node];
  const double penalty = laneChangePenalty(from, available);
  if (node < count()) {
    relax(static_cast<std::size_t>(neighbor), node, rank_[node] + penalty, driven_[node]);
    return;
  }
  const double beside = arcLengthAbreast(network_, laneOf(node), -driven_[node], neighbor);
  relax(count() + static_cast<std::size_t>(neighbor), node, rank_[node] + penalty, -beside);
}

void LaneSearch::relax(std::size_t node, std::size_t from, double rank, double driven) {
  if (driven > limits_.max_length || rank >= rank_[node]) return;
  rank_[node] = rank;
  driven_[node] = driven;
  parent_[node] = static_cast<int>(from);
  queue_.emplace_back(rank, node);
  std::push_heap(queue_.begin(), queue_.end(), std::greater<>());
}

LaneSearch::Arrival LaneSearch::arrivalAt(const LanePosition& goal) const {
  Arrival best;
  const auto lane = static_cast<std::size_t>(goal.lane);
  const std::size_t abreast = count() + lane;
  const double ahead = driven_[abreast] + goal.arc_length;
  const double tolerance = goal.lane == start_.lane ? 0.0 : kTolerance;
  if (rank_[abreast] < kInfinity && ahead >= -tolerance) {
    const double length = std::max(0.0, ahead);
    best = {rank_[abreast] + length, length, static_cast<int>(abreast)};
  }
  const double around = rank_[lane] + goal.arc_length;
  if (around < best.rank) {
    best = {around, driven_[lane] + goal.arc_length, static_cast<int>(lane)};
  }
  return best.driven <= limits_.max_length ? best : Arrival();
}

std::optional<LanePath> LaneSearch::pathTo(const LanePosition& goal) const {
  const Arrival arrival = arrivalAt(goal);
  if (arrival.node < 0) return std::nullopt;
  LanePath path;
  path.length = arrival.driven;
  for (int node = arrival.node; node >= 0; node = parent_[static_cast<std::size_t>(node)]) {
    path.lanes.push_back(laneOf(static_cast<std::size_t>(node)));
  }
  std::reverse(path.lanes.begin(), path.lanes.end());
  return path;
}

double LaneSearch::lengthToStart(LaneIndex lane) const {
  const auto node = static_cast<std::size_t>(lane);
  if (lane == start_.lane) return driven_[node];
  const double abreast = driven_[count() + node];
  return abreast < kInfinity ? abreast : driven_[node];
}

}  // namespace cdiff::map
