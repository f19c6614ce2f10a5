// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <vector>

#include "cbv/cbv_options.h"
#include "e2e_cdiff/cbv/cbv_selection.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "map/lane_graph.h"

namespace cdiff::cbv {

// Interaction score of a candidate at one point of the ego's route, in [0, 1]:
// exp(-ds^2 / 2 sigma_s^2) exp(-dT^2 / 2 sigma_T^2) exp(-d / l), with ds the difference of the
// distances still to drive [m], dT that of the arrival times at present speeds (at least v_min)
// [s], and d the distance from candidate to ego [m].

/// Time to drive `distance` [m] at `speed` [m/s], taken as at least `minimum_speed`.
double arrivalTime(double distance, double speed, double minimum_speed);

/// Score of a conflict point for a candidate `separation` meters away from the ego.
double interactionScore(const ConflictPoint& point, double separation, const CbvOptions& options);

/// The ego on its route.
struct EgoProgress {
  traffic::VehicleState state;
  double arc_length = 0.0;  ///< on its route [m]
};

/// A conflict point with its place among the lanes.
struct Conflict {
  ConflictPoint point;
  map::LanePosition place;
  double score = 0.0;
};

/// `conflict` or the reason why there is none.
struct ConflictResult {
  std::optional<Conflict> conflict;
  const char* reason = nullptr;  ///< kOutOfView, kNoWay or kDistanceMismatch
};

/// Best conflict point of a candidate with the ego's remaining route: over the points of that route
/// that lie near and ahead of the candidate and have a lane-connected route from it, the one with
/// the highest interaction score, the first of equals. The points lie at multiples of
/// sample_spacing from the route's start, and at its end.
class ConflictSearch {
 public:
  /// Keeps references to options and graph. Samples the route once.
  ConflictSearch(const CbvOptions& options, const map::LaneGraph& graph,
                 const map::Route& ego_route);

  /// For a candidate whose own lane position is `place`; at most one search of the lane graph.
  ConflictResult find(const traffic::VehicleState& candidate, const map::LanePosition& place,
                      const EgoProgress& ego) const;

 private:
  /// A point of the ego's route.
  struct Sample {
    double arc_length = 0.0;  ///< [m]
    Eigen::Vector2d position = Eigen::Vector2d::Zero();
    map::LanePosition place;
  };
  std::vector<const Sample*> samplesInView(const traffic::VehicleState& candidate,
                                           double ego_arc_length) const;
  ConflictPoint pointAt(const Sample& sample, double cbv_distance, double cbv_speed,
                        const EgoProgress& ego) const;

  const CbvOptions& options_;
  const map::LaneGraph& graph_;
  std::vector<Sample> samples_;  ///< every sample_spacing, the route's end included
};

}  // namespace cdiff::cbv
