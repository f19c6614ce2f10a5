// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <cmath>
#include <limits>

#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/map/route.h"
#include "map/lane_candidates.h"
#include "map/lane_search.h"

namespace cdiff::map {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kHeadingScale = 0.3;  // [rad]
constexpr double kDetour = 20.0;       // [m] lanes of a network may overlap where they join
constexpr double kBackwards = 0.5;     // [m] a projection may fall back by so much on its lane

/// Finds the lane of every point of a driven line.
class RouteMatcher {
 public:
  RouteMatcher(const RoadNetwork& network, const std::vector<Eigen::Vector3d>& points)
      : network_(network), points_(distinctPoints(points, 1e-3)) {
    const CandidateFinder finder(network_, points_);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      layers_.push_back(finder.find(points_[i], headingAt(i), kHeadingScale));
    }
  }

  Route match() const {
    const CheapestChoice choice = cheapestChoice(
        layers_,
        [this](std::size_t layer, const LaneCandidate& from) { return transitions(layer, from); });
    if (choice.positions.empty()) fail(choice.reached);
    std::vector<Eigen::Vector3d> points;
    std::vector<LaneIndex> lanes;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      points.push_back(points_[i].position);
      lanes.push_back(choice.positions[i].lane);
    }
    return Route(network_, points, lanes);
  }

 private:
  /// Direction from the point before to the point after.
  double headingAt(std::size_t i) const {
    const std::size_t before = i == 0 ? 0 : i - 1;
    const std::size_t after = std::min(i + 1, points_.size() - 1);
    const Eigen::Vector3d along = points_[after].position - points_[before].position;
    return std::atan2(along.y(), along.x());
  }

  std::vector<double> transitions(std::size_t layer, const LaneCandidate& from) const {
    const double distance =
        (points_[layer + 1].position - points_[layer].position).head<2>().norm();
    SearchLimits limits;
    limits.max_length = 2.0 * distance + kDetour;
    limits.routable_only = false;
    const LaneSearch search(network_, from.position, limits);
    std::vector<double> costs;
    for (const LaneCandidate& to : layers_[layer + 1]) {
      const LaneSearch::Arrival arrival = search.arrivalAt(to.position);
      const double step = to.position.arc_length - from.position.arc_length;
      const bool same_lane = to.position.lane == from.position.lane;
      if (same_lane && step >= -kBackwards) {
        costs.push_back(squared(step - distance));
      } else if (arrival.rank < kInfinity) {
        costs.push_back(squared(arrival.driven - distance) + arrival.rank - arrival.driven);
      } else {
        costs.push_back(kInfinity);
      }
    }
    return costs;
  }

  [[noreturn]] void fail(std::size_t reached) const {
    const InputPoint& from = points_[reached];
    const InputPoint& to = points_[reached + 1];
    throw core::InputError("no lane-connected way from point " + std::to_string(from.index) + " " +
                           toText(from.position) + " to point " + std::to_string(to.index) + " " +
                           toText(to.position));
  }

  static double squared(double value) { return value * value; }

  const RoadNetwork& network_;
  std::vector<InputPoint> points_;
  CandidateLayers layers_;
};

}  // namespace

Route matchRoute(const RoadNetwork& network, const std::vector<Eigen::Vector3d>& points) {
  return RouteMatcher(network, points).match();
}

}  // namespace cdiff::map
