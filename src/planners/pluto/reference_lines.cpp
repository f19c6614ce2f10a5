// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/pluto/reference_lines.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "e2e_cdiff/core/angle.h"
#include "planners/pluto/pluto_weights.h"

namespace cdiff::planners {
namespace {

using Lanes = std::vector<map::LaneIndex>;

constexpr std::size_t kDeepest = 20;      // lanes of a line
constexpr std::size_t kMostFound = 24;    // lines that the search keeps
constexpr double kShortShare = 0.8;       // of the full length
constexpr double kSameLine = 0.5;         // [m]
constexpr double kLeastLine = 2.0;        // [m]
constexpr std::size_t kLinePoints = 121;  // of a whole line

/// The lane outside the junction that a lane leads to; itself where it lies outside.
map::LaneIndex laneBeyond(const map::RoadNetwork& network, map::LaneIndex lane) {
  for (std::size_t i = 0; i < kDeepest && network.lane(lane).internal; ++i) {
    if (network.lane(lane).next.empty()) break;
    lane = network.lane(lane).next.front().to;
  }
  return lane;
}

double lineLength(const map::RoadNetwork& network, map::LaneIndex lane) {
  return network.lane(lane).centerline.length();
}

/// The successor that turns least up to the end of its junction; kNoLane where there is none.
map::LaneIndex straightOn(const map::RoadNetwork& network, map::LaneIndex from) {
  const geometry::Polyline& line = network.lane(from).centerline;
  const double heading = line.headingAt(line.length());
  map::LaneIndex best = map::kNoLane;
  double smallest = std::numeric_limits<double>::infinity();
  for (const map::LaneLink& link : network.lane(from).next) {
    const map::Lane& next = network.lane(link.to);
    if (!next.routable) continue;
    const double end = next.internal ? next.centerline.length() : 0.0;
    const double turn = std::abs(core::angleDifference(next.centerline.headingAt(end), heading));
    if (turn >= smallest) continue;
    best = link.to;
    smallest = turn;
  }
  return best;
}

/// Poses every 1 m along lanes, from an arc length on the first on.
void appendPoses(const map::RoadNetwork& network, const Lanes& lanes, double arc_length,
                 std::vector<geometry::Pose2d>& poses) {
  for (const map::LaneIndex lane : lanes) {
    const geometry::Polyline& line = network.lane(lane).centerline;
    for (; arc_length <= line.length() && poses.size() < kLinePoints; arc_length += 1.0)
      poses.push_back({line.positionAt(arc_length), line.headingAt(arc_length)});
    arc_length -= line.length();
  }
}

/// The route ahead and, where it ends, the lanes straight on.
ReferenceLine lineOfRoute(const map::RoadNetwork& network, const map::Route& route,
                          double arc_length) {
  const geometry::Polyline& path = route.path();
  ReferenceLine line;
  double s = std::max(0.0, arc_length);
  for (; s <= path.length() && line.poses.size() < kLinePoints; s += 1.0)
    line.poses.push_back({path.positionAt(s), path.headingAt(s)});
  const map::LaneIndex last = route.lanes().back();
  Lanes beyond = {last};
  const double end =
      network.lane(last).centerline.project(path.positionAt(path.length())).arc_length;
  double ahead = lineLength(network, last) - end;
  while (ahead < kLineLength && beyond.size() < kDeepest) {
    const map::LaneIndex next = straightOn(network, beyond.back());
    if (next == map::kNoLane) break;
    beyond.push_back(next);
    ahead += lineLength(network, next);
  }
  appendPoses(network, beyond, end + s - path.length(), line.poses);
  const geometry::Pose2d tail = {path.positionAt(path.length()), path.headingAt(path.length())};
  while (line.length() < kLeastLine) {
    const geometry::Pose2d from = line.poses.empty() ? tail : line.poses.back();
    line.poses.push_back({from.position + geometry::direction(from.heading), from.heading});
  }
  return line;
}

/// A depth-first search of lanes along the edges of a route.
class LaneDepthSearch {
 public:
  LaneDepthSearch(const map::RoadNetwork& network, const std::vector<std::string>& edges)
      : network_(network), edges_(edges) {}

  /// Lines from `arc_length` on a lane; `edge`: place among the edges of the one that the lane is
  /// on or, inside a junction, that it comes from.
  void search(map::LaneIndex lane, double arc_length, std::size_t edge) {
    arc_length_ = arc_length;
    path_ = {lane};
    descend(lineLength(network_, lane) - arc_length, edge);
  }
  std::vector<ReferenceLine> take() { return std::move(lines_); }

 private:
  void descend(double length, std::size_t edge) {
    if (lines_.size() >= kMostFound) return;
    bool goes_on = false;
    if (length < kLineLength && path_.size() < kDeepest) {
      for (const map::LaneIndex next : successors(edge)) {
        goes_on = true;
        path_.push_back(next);
        const bool outside = !network_.lane(next).internal;
        descend(length + lineLength(network_, next), outside ? edge + 1 : edge);
        path_.pop_back();
      }
    }
    if (goes_on) return;
    ReferenceLine line;
    appendPoses(network_, path_, arc_length_, line.poses);
    if (line.poses.size() > 1) lines_.push_back(std::move(line));
  }

  /// Toward the next edge of the route; from its last one straight on.
  Lanes successors(std::size_t edge) const {
    const map::LaneIndex here = path_.back();
    if (edge + 1 >= edges_.size()) {
      const map::LaneIndex next = straightOn(network_, here);
      return next == map::kNoLane ? Lanes{} : Lanes{next};
    }
    Lanes next;
    for (const map::LaneLink& link : network_.lane(here).next) {
      const map::Lane& beyond = network_.lane(laneBeyond(network_, link.to));
      if (network_.lane(link.to).routable && beyond.edge_id == edges_[edge + 1])
        next.push_back(link.to);
    }
    return next;
  }

  const map::RoadNetwork& network_;
  const std::vector<std::string>& edges_;
  double arc_length_ = 0.0;
  Lanes path_;
  std::vector<ReferenceLine> lines_;
};

/// The lane that the vehicle drives along: the nearest one that runs its way, or that of its route.
map::LaneIndex ownLane(const map::RoadNetwork& network, const map::Route& route, double arc_length,
                       const traffic::VehicleState& state) {
  constexpr double kNear = 2.0;  // [m] of its center line
  const double most_turn = core::degreesToRadians(60.0);
  const map::LaneIndex of_route = route.laneAt(std::min(arc_length, route.length()));
  for (const map::LaneMatch& match :
       network.lanesNear(state.position, state.elevation, kNear, state.heading)) {
    const map::Lane& lane = network.lane(match.lane);
    const bool same_edge = lane.edge_id == network.lane(of_route).edge_id;
    if (same_edge && std::abs(match.heading_difference) < most_turn) return match.lane;
  }
  return of_route;
}

std::size_t edgeAt(const map::Route& route, double arc_length) {
  std::size_t edge = 0;
  while (edge + 1 < route.edgeStarts().size() && route.edgeStarts()[edge + 1] <= arc_length) ++edge;
  return edge;
}

bool sameLine(const ReferenceLine& kept, const ReferenceLine& other) {
  constexpr std::size_t kStride = 4;  // points
  for (std::size_t i = 0; i < other.poses.size(); i += kStride) {
    const LinePlace place = placeOn(kept, other.poses[i].position);
    const bool beyond = place.arc_length >= kept.length();
    if (!beyond && place.distance >= kSameLine) return false;
    if (beyond) return other.length() < kept.length() + static_cast<double>(kStride);
  }
  return true;
}

}  // namespace

std::vector<ReferenceLine> referenceLines(const map::RoadNetwork& network, const map::Route& route,
                                          double arc_length, const traffic::VehicleState& state,
                                          std::size_t most) {
  const map::LaneIndex own = ownLane(network, route, arc_length, state);
  LaneDepthSearch search(network, route.edges());
  for (const map::LaneIndex lane : {own, network.lane(own).left, network.lane(own).right}) {
    if (lane == map::kNoLane || !network.lane(lane).allows_cars) continue;
    const double place = network.lane(lane).centerline.project(state.position).arc_length;
    search.search(lane, place, edgeAt(route, arc_length));
  }
  std::vector<ReferenceLine> kept = {lineOfRoute(network, route, arc_length)};
  const std::vector<ReferenceLine> found = search.take();
  double longest = kept.front().length();
  for (const ReferenceLine& line : found) longest = std::max(longest, line.length());
  const double least = kShortShare * kLineLength;
  for (const ReferenceLine& line : found) {
    const bool known = std::any_of(kept.begin(), kept.end(), [&](const ReferenceLine& other) {
      return sameLine(other, line);
    });
    const bool too_short = line.length() < least && line.length() < longest;
    if (!known && !too_short && kept.size() < most) kept.push_back(line);
  }
  return kept;
}

LinePlace placeOn(const ReferenceLine& line, const Eigen::Vector2d& point) {
  LinePlace best;
  best.distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < line.poses.size(); ++i) {
    const Eigen::Vector2d& begin = line.poses[i].position;
    const Eigen::Vector2d along = line.poses[i + 1].position - begin;
    const double squared = along.squaredNorm();
    const double share =
        squared > 0.0 ? std::clamp((point - begin).dot(along) / squared, 0.0, 1.0) : 0.0;
    const Eigen::Vector2d away = point - begin - share * along;
    const double distance = away.norm();
    if (distance >= best.distance) continue;
    best.distance = distance;
    best.arc_length = static_cast<double>(i) + share;
    best.heading = line.poses[i].heading;
    best.offset = geometry::cross(geometry::direction(best.heading), point - begin);
  }
  return best;
}

}  // namespace cdiff::planners
