// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "map/lane_candidates.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "map/lane_search.h"

namespace cdiff::map {
namespace {

constexpr double kGate = 1.5;           // [m] to the centerline
constexpr double kLevelHeight = 3.0;    // [m]
constexpr double kDistanceScale = 0.5;  // [m] a distance of so much costs 1
constexpr double kStubLength = 0.05;    // [m] lanes shorter than this have no reliable heading

bool hasElevation(const RoadNetwork& network) {
  constexpr double kFlat = 0.5;  // [m]
  for (const Lane& lane : network.lanes()) {
    for (const Eigen::Vector3d& point : lane.centerline.points()) {
      if (std::abs(point.z()) > kFlat) return true;
    }
  }
  return false;
}

}  // namespace

std::string toText(const Eigen::Vector3d& point) {
  return "(" + core::formatFixed(point.x(), 2) + ", " + core::formatFixed(point.y(), 2) + ")";
}

std::vector<InputPoint> distinctPoints(const std::vector<Eigen::Vector3d>& points,
                                       double distance) {
  std::vector<InputPoint> kept;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) {
      throw core::InputError("point " + std::to_string(i) + " has a coordinate that is not finite");
    }
    const bool repeated =
        !kept.empty() && (points[i] - kept.back().position).head<2>().norm() <= distance;
    if (!repeated) kept.push_back({points[i], i});
  }
  if (kept.size() < 2) {
    throw core::InputError("a route needs at least two distinct points; " +
                           std::to_string(kept.size()) + " of " + std::to_string(points.size()) +
                           " were distinct");
  }
  return kept;
}

CandidateFinder::CandidateFinder(const RoadNetwork& network, const std::vector<InputPoint>& points)
    : network_(network), radius_(kGate) {
  const bool flat = std::all_of(points.begin(), points.end(),
                                [](const InputPoint& point) { return point.position.z() == 0.0; });
  use_elevation_ = !flat || !hasElevation(network);
  for (const Lane& lane : network.lanes()) {
    if (lane.allows_cars) radius_ = std::max(radius_, lane.width / 2.0);
  }
}

/// Networks made from OpenDRIVE keep the elevation of few points: on a ramp a lane may lie 3 m off
/// the road. So a point without a lane on its level takes the lanes of the nearest one.
std::vector<LaneMatch> CandidateFinder::acceptedNear(const Eigen::Vector3d& point,
                                                     double heading) const {
  const Eigen::Vector2d position = point.head<2>();
  const auto find = [&](double height) {
    auto matches = network_.lanesNear(position, point.z(), radius_, heading, height);
    const auto rejects = [&](const LaneMatch& match) { return !accepts(match); };
    matches.erase(std::remove_if(matches.begin(), matches.end(), rejects), matches.end());
    return matches;
  };
  std::vector<LaneMatch> matches = find(use_elevation_ ? kLevelHeight : kInfinity);
  if (!matches.empty() || !use_elevation_) return matches;
  matches = find(kInfinity);
  double nearest = kInfinity;
  const auto height = [&](const LaneMatch& match) {
    return std::abs(match.projection.elevation - point.z());
  };
  for (const LaneMatch& match : matches) nearest = std::min(nearest, height(match));
  const auto other_level = [&](const LaneMatch& match) {
    return height(match) > nearest + kLevelHeight;
  };
  matches.erase(std::remove_if(matches.begin(), matches.end(), other_level), matches.end());
  return matches;
}

bool CandidateFinder::accepts(const LaneMatch& match) const {
  const double half_width = network_.lane(match.lane).width / 2.0;
  return match.projection.distance <= std::max(kGate, half_width);
}

void CandidateFinder::failOffLanes(const InputPoint& point) const {
  const std::string name = "point " + std::to_string(point.index) + " " + toText(point.position);
  const std::vector<LaneMatch> near = network_.lanesNear(point.position.head<2>(), 1000.0);
  if (near.empty()) {
    throw core::InputError(name +
                           " is more than 1 km off every lane; is it a point of this network?");
  }
  throw core::InputError(name + " is " + core::formatFixed(near.front().projection.distance, 2) +
                         " m off every lane; the nearest is '" +
                         network_.lane(near.front().lane).id +
                         "', and at most 1.5 m or half its width was expected");
}

std::vector<LaneCandidate> CandidateFinder::find(const InputPoint& point, double heading,
                                                 double heading_scale) const {
  std::vector<LaneMatch> matches = acceptedNear(point.position, heading);
  const auto keepIf = [&](auto&& keep) {
    if (std::any_of(matches.begin(), matches.end(), keep)) {
      matches.erase(std::remove_if(matches.begin(), matches.end(), std::not_fn(keep)),
                    matches.end());
    }
  };
  if (matches.empty()) failOffLanes(point);
  keepIf([&](const LaneMatch& match) {
    return network_.lane(match.lane).centerline.length() > kStubLength;
  });
  keepIf([&](const LaneMatch& match) { return network_.lane(match.lane).routable; });
  std::vector<LaneCandidate> candidates;
  for (const LaneMatch& match : matches) {
    const double distance = match.projection.distance / kDistanceScale;
    const double turn = match.heading_difference / heading_scale;
    candidates.push_back(
        {{match.lane, match.projection.arc_length}, distance * distance + turn * turn});
  }
  return candidates;
}

CheapestChoice cheapestChoice(const CandidateLayers& layers, const TransitionCosts& transitions) {
  CheapestChoice choice;
  std::vector<std::vector<std::size_t>> parents(layers.size());
  std::vector<double> costs;
  for (const LaneCandidate& candidate : layers.front()) costs.push_back(candidate.cost);
  for (std::size_t i = 0; i + 1 < layers.size(); ++i) {
    std::vector<double> next(layers[i + 1].size(), kInfinity);
    parents[i + 1].resize(next.size());
    for (std::size_t from = 0; from < costs.size(); ++from) {
      if (costs[from] == kInfinity) continue;
      const std::vector<double> step = transitions(i, layers[i][from]);
      for (std::size_t to = 0; to < next.size(); ++to) {
        const double cost = costs[from] + step[to] + layers[i + 1][to].cost;
        if (cost >= next[to]) continue;
        next[to] = cost;
        parents[i + 1][to] = from;
      }
    }
    costs = std::move(next);
    if (*std::min_element(costs.begin(), costs.end()) == kInfinity) return choice;
    choice.reached = i + 1;
  }
  auto best =
      static_cast<std::size_t>(std::min_element(costs.begin(), costs.end()) - costs.begin());
  choice.positions.resize(layers.size());
  for (std::size_t i = layers.size(); i-- > 0;) {
    choice.positions[i] = layers[i][best].position;
    if (i > 0) best = parents[i][best];
  }
  return choice;
}

}  // namespace cdiff::map
