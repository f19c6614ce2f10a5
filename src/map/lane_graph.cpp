// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "map/lane_graph.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "map/lane_search.h"
#include "map/route_builder.h"

namespace cdiff::map {
namespace {

constexpr double kBeyondJunction = 10.0;  // [m] at least so much of the edge after a junction
constexpr double kSamePlace = 1e-3;       // [m]

SearchLimits limitsOf(double max_length, bool lane_changes, const TurnRounds& turn_rounds) {
  SearchLimits limits;
  limits.max_length = max_length;
  limits.lane_changes = lane_changes;
  limits.turn_rounds = &turn_rounds;
  return limits;
}

/// The first lane outside the junction that a link leads into.
const Lane& laneAfter(const RoadNetwork& network, LaneIndex lane) {
  constexpr int kLongestChain = 8;  // internal lanes in a row
  for (int i = 0; i < kLongestChain && network.lane(lane).internal; ++i) {
    if (network.lane(lane).next.empty()) break;
    lane = network.lane(lane).next.front().to;
  }
  return network.lane(lane);
}

double endHeading(const Lane& lane) { return lane.centerline.headingAt(lane.centerline.length()); }

/// Goes straight on along routable lanes.
class Continuation {
 public:
  Continuation(const RoadNetwork& network, const TurnRounds& turn_rounds, LaneIndex lane)
      : network_(network), turn_rounds_(turn_rounds) {
    path_.lanes.push_back(lane);
  }

  /// Adds lanes until `length` meters lie beyond `begin` on the first lane and the last lies
  /// outside junctions.
  void extend(double begin, double length) {
    double end = network_.lane(path_.lanes.front()).centerline.length() - begin;
    double goal = length;
    while (end < goal || network_.lane(path_.lanes.back()).internal) {
      const bool inside = network_.lane(path_.lanes.back()).internal;
      if (inside) goal = std::max(goal, end + kBeyondJunction);
      if (!addNext()) break;
      const double added = network_.lane(path_.lanes.back()).centerline.length();
      if (inside && !network_.lane(path_.lanes.back()).internal) {
        goal = std::max(length, end + std::min(added, kBeyondJunction));
      }
      end += added;
    }
    surplus_ = std::max(0.0, end - goal);
  }
  const LanePath& path() const { return path_; }
  /// Where the route ends on its last lane [m].
  double goal() const {
    return std::max(0.0, network_.lane(path_.lanes.back()).centerline.length() - surplus_);
  }

 private:
  bool addNext() {
    const LaneIndex here = path_.lanes.back();
    LaneIndex best = straightest(here);
    if (best == kNoLane) {  // the lane ends: change to a neighbor that goes on
      const Lane& lane = network_.lane(here);
      for (const LaneIndex beside : {lane.right, lane.left}) {
        if (beside == kNoLane || best != kNoLane) continue;
        best = straightest(beside);
        if (best != kNoLane) path_.lanes.push_back(beside);
      }
    }
    if (best == kNoLane) return false;
    path_.lanes.push_back(best);
    return true;
  }

  /// The next lane with the smallest change of heading up to the end of its junction, ties by
  /// index.
  LaneIndex straightest(LaneIndex from) const {
    LaneIndex best = kNoLane;
    double smallest = 0.0;
    for (const LaneLink& link : network_.lane(from).next) {
      const Lane& next = network_.lane(link.to);
      if (!next.routable) continue;
      if (turnsRound(network_.lane(from), link) && turn_rounds_.count({from, link.to}) == 0)
        continue;
      const double heading = next.internal ? endHeading(next) : next.centerline.headingAt(0.0);
      const double turn = std::abs(core::angleDifference(heading, endHeading(network_.lane(from))));
      if (best != kNoLane && turn >= smallest) continue;
      best = link.to;
      smallest = turn;
    }
    return best;
  }

  const RoadNetwork& network_;
  const TurnRounds& turn_rounds_;
  LanePath path_;
  double surplus_ = 0.0;
};

}  // namespace

TurnRounds turnRounds(const RoadNetwork& network) {
  TurnRounds found;
  for (std::size_t i = 0; i < network.lanes().size(); ++i) {
    for (const LaneLink& link : network.lanes()[i].next) {
      if (turnsRound(network.lanes()[i], link)) found.emplace(static_cast<LaneIndex>(i), link.to);
    }
  }
  return found;
}

std::string turnRoundText(const RoadNetwork& network) {
  constexpr std::size_t kShown = 3;
  const TurnRounds found = turnRounds(network);
  if (found.empty()) return {};
  std::vector<std::string> shown;
  for (const auto& [from, to] : found) {
    if (shown.size() == kShown) break;
    shown.push_back(network.lane(from).id + " -> " + laneAfter(network, to).id);
  }
  if (found.size() > kShown) shown.emplace_back("...");
  return std::to_string(found.size()) +
         (found.size() == 1 ? " connection turns" : " connections turn") + " round (" +
         core::joinText(shown, ", ") + "); CBVs use those of the ego's route only";
}

LaneGraph LaneGraph::allowingTurnsOf(const Route& route) const {
  const std::set<LaneIndex> driven(route.lanes().begin(), route.lanes().end());
  std::set<std::pair<LaneIndex, LaneIndex>> steps;  // a route skips lanes shorter than its spacing
  for (std::size_t i = 1; i < route.lanes().size(); ++i)
    steps.emplace(route.lanes()[i - 1], route.lanes()[i]);
  LaneGraph graph(network_);
  for (const auto& [from, to] : turnRounds(network_)) {
    const bool inside = network_.lane(to).internal && driven.count(to) != 0;
    const LaneIndex after = network_.findLane(laneAfter(network_, to).id);
    if (inside || steps.count({from, after}) != 0) graph.turn_rounds_.emplace(from, to);
  }
  return graph;
}

std::optional<LanePath> LaneGraph::shortestPath(const LanePosition& start, const LanePosition& goal,
                                                double max_length, bool lane_changes) const {
  return LaneSearch(network_, start, limitsOf(max_length, lane_changes, turn_rounds_)).pathTo(goal);
}

std::vector<double> LaneGraph::distancesFrom(const LanePosition& start, double max_length,
                                             bool lane_changes) const {
  const LaneSearch search(network_, start, limitsOf(max_length, lane_changes, turn_rounds_));
  std::vector<double> lengths(network_.lanes().size());
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    lengths[i] = search.lengthToStart(static_cast<LaneIndex>(i));
  }
  return lengths;
}

Route LaneGraph::toRoute(const LanePath& path, double start_arc_length,
                         double goal_arc_length) const {
  if (path.lanes.empty()) throw core::InputError("a route needs at least one lane");
  std::vector<LaneStretch> drive;
  appendPath(network_, path, start_arc_length, goal_arc_length, drive);
  return buildRoute(network_, drive);
}

Route LaneGraph::extended(const Route& route, double length) const {
  const LaneIndex last = route.lanes().back();
  const geometry::Polyline& line = network_.lane(last).centerline;
  const double missing = length - route.length();
  if (missing <= 0.0 && !network_.lane(last).internal) return route;
  const Eigen::Vector3d end = route.path().points().back();
  const double begin = line.project(end.head<2>()).arc_length;
  Continuation continuation(network_, turn_rounds_, last);
  continuation.extend(begin, std::max(0.0, missing));
  const std::vector<LaneIndex>& onward = continuation.path().lanes;
  const bool stays = onward.size() == 1;
  if (stays && continuation.goal() - begin < 0.1) return route;
  // At the very end of a lane that ends there is no way left on which to change to its neighbor.
  const bool at_end = line.length() - begin < kSamePlace;
  if (!stays && at_end && !follows(network_, onward[0], onward[1])) return route;
  const Route rest = toRoute(continuation.path(), begin, continuation.goal());
  std::vector<Eigen::Vector3d> points = route.path().points();
  std::vector<LaneIndex> lanes = route.lanes();
  // The first meter joins the route's last point, which may lie beside the centerline.
  for (std::size_t i = 1; i < rest.lanes().size(); ++i) {
    points.push_back(rest.path().points()[i]);
    lanes.push_back(rest.lanes()[i]);
  }
  return Route(network_, points, lanes);
}

}  // namespace cdiff::map
