// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "map/lane_graph.h"

namespace cdiff::map {

// Lanes that a point (map frame [m]) may lie on, and the cheapest choice of one lane for each point
// of a row.

/// A lane that a point may lie on.
struct LaneCandidate {
  LanePosition position;
  double cost = 0.0;  ///< grows with the distance to the centerline and the heading difference
};

/// A point of the input; neighbors that coincide have been merged.
struct InputPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  std::size_t index = 0;  ///< in the input
};

/// "(12.00, 3.50)".
std::string toText(const Eigen::Vector3d& point);

/// Points farther than `distance` [m] from the one kept before. Throws InputError when fewer than
/// two remain or a coordinate is not finite.
std::vector<InputPoint> distinctPoints(const std::vector<Eigen::Vector3d>& points, double distance);

/// Finds candidates: lanes whose centerline is within 1.5 m or whose half width covers the point,
/// on the point's level.
class CandidateFinder {
 public:
  /// Elevations are ignored when every point has z = 0 in a network with elevation.
  CandidateFinder(const RoadNetwork& network, const std::vector<InputPoint>& points);

  /// Candidates of a point that is passed with a heading; a heading difference of `heading_scale`
  /// [rad] costs 1. Throws InputError when there is none.
  std::vector<LaneCandidate> find(const InputPoint& point, double heading,
                                  double heading_scale) const;

 private:
  bool accepts(const LaneMatch& match) const;
  std::vector<LaneMatch> acceptedNear(const Eigen::Vector3d& point, double heading) const;
  [[noreturn]] void failOffLanes(const InputPoint& point) const;

  const RoadNetwork& network_;
  bool use_elevation_ = true;
  double radius_ = 0.0;
};

/// Candidates of each point, in order.
using CandidateLayers = std::vector<std::vector<LaneCandidate>>;
/// Cost from a candidate of layer i to each candidate of layer i + 1; infinity where there is no
/// route.
using TransitionCosts =
    std::function<std::vector<double>(std::size_t layer, const LaneCandidate& from)>;

/// The cheapest choice (Viterbi); ties go to the earlier candidate.
struct CheapestChoice {
  std::vector<LanePosition>
      positions;            ///< one for each layer; empty when some layer cannot be reached
  std::size_t reached = 0;  ///< last layer that can be reached
};
CheapestChoice cheapestChoice(const CandidateLayers& layers, const TransitionCosts& transitions);

}  // namespace cdiff::map
