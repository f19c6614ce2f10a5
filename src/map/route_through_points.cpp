// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <cmath>
#include <limits>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "map/lane_candidates.h"
#include "map/lane_search.h"
#include "map/route_builder.h"
#include "map/route_source.h"

namespace cdiff::map {
namespace {

constexpr double kMergeDistance = 0.1;  // [m] key points nearer than this are one
constexpr double kHeadingScale =
    0.6;                            // [rad] towards the next key point, which may lie behind a bend
constexpr double kBackwards = 0.5;  // [m] a projection may fall back by so much on its lane
constexpr double kFarSearch = 20000.0;  // distinguishes a long route from none [m]

/// Joins key points by the cheapest choice of lanes and the shortest routes between them.
class KeyPointRoute {
 public:
  KeyPointRoute(const RoadNetwork& network, const std::vector<Eigen::Vector3d>& points)
      : network_(network), points_(distinctPoints(points, kMergeDistance)) {
    const CandidateFinder finder(network_, points_);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      layers_.push_back(finder.find(points_[i], headingAt(i), kHeadingScale));
    }
  }

  Route build() const {
    const CheapestChoice choice = cheapestChoice(
        layers_,
        [this](std::size_t layer, const LaneCandidate& from) { return transitions(layer, from); });
    if (choice.positions.empty()) fail(choice.reached);
    return join(choice.positions);
  }

 private:
  double headingAt(std::size_t i) const {
    const std::size_t begin = std::min(i, points_.size() - 2);
    const Eigen::Vector3d along = points_[begin + 1].position - points_[begin].position;
    return std::atan2(along.y(), along.x());
  }

  double distanceAfter(std::size_t layer) const {
    return (points_[layer + 1].position - points_[layer].position).head<2>().norm();
  }

  static double limitFor(double distance) { return 2.0 * distance + 20.0; }

  static bool goesOn(const LanePosition& from, const LanePosition& to) {
    return from.lane == to.lane && to.arc_length >= from.arc_length - kBackwards;
  }

  std::vector<double> transitions(std::size_t layer, const LaneCandidate& from) const {
    const double distance = distanceAfter(layer);
    SearchLimits limits;
    limits.max_length = limitFor(distance);
    const LaneSearch search(network_, from.position, limits);
    std::vector<double> costs;
    for (const LaneCandidate& to : layers_[layer + 1]) {
      const bool direct = goesOn(from.position, to.position);
      const double rank = direct ? to.position.arc_length - from.position.arc_length
                                 : search.arrivalAt(to.position).rank;
      costs.push_back(rank < kInfinity ? std::abs(rank - distance) : kInfinity);
    }
    return costs;
  }

  Route join(const std::vector<LanePosition>& positions) const {
    LanePosition here = positions.front();
    std::vector<LaneStretch> drive = {{here.lane, here.arc_length, here.arc_length}};
    for (std::size_t i = 1; i < positions.size(); ++i) {
      const LanePosition& goal = positions[i];
      if (goesOn(here, goal)) {
        drive.back().end = std::max(drive.back().end, goal.arc_length);
      } else {
        const auto path = LaneSearch(network_, here, SearchLimits()).pathTo(goal);
        if (!path) fail(i - 1);
        appendPath(network_, *path, here.arc_length, goal.arc_length, drive);
      }
      here = {goal.lane, drive.back().end};
    }
    return buildRoute(network_, drive);
  }

  /// Shortest route between any candidates of two neighboring points, however long [m].
  double shortestRoute(std::size_t layer) const {
    double shortest = kInfinity;
    SearchLimits limits;
    limits.max_length = kFarSearch;
    for (const LaneCandidate& from : layers_[layer]) {
      const LaneSearch search(network_, from.position, limits);
      for (const LaneCandidate& to : layers_[layer + 1]) {
        shortest = std::min(shortest, search.arrivalAt(to.position).driven);
      }
    }
    return shortest;
  }

  [[noreturn]] void fail(std::size_t reached) const {
    const InputPoint& from = points_[reached];
    const InputPoint& to = points_[reached + 1];
    const double distance = distanceAfter(reached);
    const double length = shortestRoute(reached);
    if (length > limitFor(distance) && length < kInfinity) {
      throw core::InputError("route from point " + std::to_string(from.index) + " " +
                             toText(from.position) + " to point " + std::to_string(to.index) + " " +
                             toText(to.position) + " is " + core::formatFixed(length, 1) +
                             " m for a distance of " + core::formatFixed(distance, 1) +
                             " m (limit twice the distance + 20 m)");
    }
    throw core::InputError("no lane-connected route from point " + std::to_string(from.index) +
                           " " + toText(from.position) + " to point " + std::to_string(to.index) +
                           " " + toText(to.position));
  }

  const RoadNetwork& network_;
  std::vector<InputPoint> points_;
  CandidateLayers layers_;
};

}  // namespace

Route routeThroughPoints(const LaneGraph& graph, const std::vector<Eigen::Vector3d>& points) {
  return KeyPointRoute(graph.network(), points).build();
}

}  // namespace cdiff::map
