// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/map/route.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/exceptions.h"
#include "map/lane_candidates.h"
#include "map/lane_search.h"
#include "map/route_builder.h"

namespace cdiff::map {
namespace {

constexpr double kDistinct = 1e-3;  // [m] as Polyline merges

/// What happens between two neighboring points of a route.
struct Step {
  double begin = 0.0;  ///< arc length of the first point [m]
  double end = 0.0;    ///< arc length of the second point [m]
};

/// Lanes driven from one point's lane to the next point's, both included; lanes too short to hold a
/// point are filled in.
std::vector<LaneIndex> lanesBetween(const RoadNetwork& network, const geometry::Polyline& path,
                                    const Step& step, LaneIndex from, LaneIndex to) {
  if (from == to) return {from};
  if (follows(network, from, to)) return {from, to};
  if (network.lane(from).left == to || network.lane(from).right == to) return {from, to};
  const LanePosition start = {
      from, network.lane(from).centerline.project(path.positionAt(step.begin)).arc_length};
  const LanePosition goal = {
      to, network.lane(to).centerline.project(path.positionAt(step.end)).arc_length};
  SearchLimits limits;
  limits.max_length = 2.0 * (step.end - step.begin) + 20.0;
  limits.routable_only = false;
  const auto found = LaneSearch(network, start, limits).pathTo(goal);
  return found ? found->lanes : std::vector<LaneIndex>{from, to};
}

const LaneLink* linkBetween(const RoadNetwork& network, LaneIndex from, LaneIndex to) {
  for (const LaneLink& link : network.lane(from).next) {
    if (link.to == to) return &link;
  }
  return nullptr;
}

}  // namespace

Route::Route(const RoadNetwork& network, const std::vector<Eigen::Vector3d>& points,
             const std::vector<LaneIndex>& lanes) {
  if (points.size() != lanes.size()) {
    throw core::InputError("a route has " + std::to_string(points.size()) + " points but " +
                           std::to_string(lanes.size()) + " lanes");
  }
  std::vector<Eigen::Vector3d> distinct;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool repeated =
        !distinct.empty() && (points[i] - distinct.back()).head<2>().norm() < kDistinct;
    if (repeated) continue;
    const Lane& lane = network.lane(lanes[i]);
    distinct.push_back(points[i]);
    lanes_.push_back(lanes[i]);
    speed_limits_.push_back(lane.speed_limit);
    in_junction_.push_back(lane.internal);
  }
  path_ = geometry::Polyline(distinct);
  noteJunctions();
  noteEdge(network.lane(lanes_.front()), 0.0);
  for (std::size_t i = 1; i < lanes_.size(); ++i) noteStep(network, i);
}

void Route::noteJunctions() {
  for (std::size_t i = 0; i < in_junction_.size(); ++i) {
    if (!in_junction_[i]) continue;
    const double begin = path_.arcLengths()[i];
    const double end = path_.arcLengths()[std::min(i + 1, in_junction_.size() - 1)];
    if (i > 0 && in_junction_[i - 1]) {
      junctions_.back().second = end;
    } else {
      junctions_.emplace_back(begin, end);
    }
  }
}

void Route::noteEdge(const Lane& lane, double arc_length) {
  if (lane.internal || (!edges_.empty() && edges_.back() == lane.edge_id)) return;
  edges_.push_back(lane.edge_id);
  edge_starts_.push_back(arc_length);
}

/// Edges, stop lines and lane changes between point `i` and the one before it.
void Route::noteStep(const RoadNetwork& network, std::size_t i) {
  const Step step = {path_.arcLengths()[i - 1], path_.arcLengths()[i]};
  const std::vector<LaneIndex> lanes = lanesBetween(network, path_, step, lanes_[i - 1], lanes_[i]);
  for (std::size_t j = 1; j < lanes.size(); ++j) {
    const Lane& lane = network.lane(lanes[j - 1]);
    noteEdge(network.lane(lanes[j]), step.end);
    if (lane.left == lanes[j] || lane.right == lanes[j]) lane_changes_.push_back(step.end);
    const LaneLink* link = linkBetween(network, lanes[j - 1], lanes[j]);
    if (link == nullptr || (link->signal_id.empty() && !link->hasStopSign())) continue;
    const Eigen::Vector2d stop = lane.centerline.points().back().head<2>();
    const double arc_length = path_.project(stop, step.begin, step.end).arc_length;
    if (link->hasStopSign()) stop_signs_.push_back(arc_length);
    if (!link->signal_id.empty())
      signals_.push_back({arc_length, link->signal_id, link->signal_link});
  }
}

std::size_t Route::pointIndex(double arc_length) const {
  const std::vector<double>& arcs = path_.arcLengths();
  const auto after = std::upper_bound(arcs.begin(), arcs.end(), arc_length);
  return after == arcs.begin() ? 0 : static_cast<std::size_t>(after - arcs.begin()) - 1;
}

LaneIndex Route::laneAt(double arc_length) const { return lanes_[pointIndex(arc_length)]; }

double Route::speedLimitAt(double arc_length) const {
  return speed_limits_[pointIndex(arc_length)];
}

bool Route::inJunctionAt(double arc_length) const { return in_junction_[pointIndex(arc_length)]; }

RouteProgress::RouteProgress(const Route& route, double completion_percent,
                             double completion_distance)
    : route_(&route),
      completion_percent_(completion_percent),
      completion_distance_(completion_distance),
      distance_to_end_(route.length()) {}

void RouteProgress::update(const Eigen::Vector2d& position) {
  const auto near = route_->path().projectNear(position, arc_length_, kRouteWindow);
  arc_length_ = std::max(arc_length_, near.arc_length);
  deviation_ = near.distance;
  distance_to_end_ = (position - route_->path().points().back().head<2>()).norm();
}

double RouteProgress::percent() const {
  const double percent = 100.0 * arc_length_ / route_->length();
  const bool complete = percent >= completion_percent_ && distance_to_end_ <= completion_distance_;
  return complete ? 100.0 : std::min(percent, std::nextafter(100.0, 0.0));
}

namespace {

constexpr double kLineHeadingScale = 0.3;  // [rad]
constexpr double kDetour = 20.0;           // [m] lanes of a network may overlap where they join
constexpr double kLineBackwards = 0.5;     // [m] a projection may fall back by so much on its lane

/// Finds the lane of every point of a driven line.
class RouteMatcher {
 public:
  RouteMatcher(const RoadNetwork& network, const std::vector<Eigen::Vector3d>& points)
      : network_(network), points_(distinctPoints(points, 1e-3)) {
    const CandidateFinder finder(network_, points_);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      layers_.push_back(finder.find(points_[i], headingAt(i), kLineHeadingScale));
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
      if (same_lane && step >= -kLineBackwards) {
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
    throw core::InputError("no lane-connected route from point " + std::to_string(from.index) +
                           " " + toText(from.position) + " to point " + std::to_string(to.index) +
                           " " + toText(to.position));
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
