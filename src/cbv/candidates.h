// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/cbv/cbv_selection.h"
#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "map/lane_graph.h"

namespace cdiff::cbv {

/// Options of CBV identification; defaults: RIFT's rule.yaml in evaluation.
struct CbvOptions {
  std::string ranking = "score";        ///< score | nearest | gates
  double search_radius = 60.0;          ///< ego center to candidate center [m]
  double minimum_distance = 10.0;       ///< [m]
  double interaction_radius = 90.0;     ///< candidate to a point of the ego's route, straight [m]
  double field_of_view = 150.0;         ///< full angle in which that point must lie [deg]
  double route_distance_gate = 20.0;    ///< largest |s_cbv - s_ego| at the conflict point [m]
  double preview_distance = 2.0;        ///< ahead of the candidate's center, must lie on a lane [m]
  double junction_heading_gate = 20.0;  ///< in a junction: vehicle against lane heading [deg]
  double ego_route_length = 200.0;      ///< part of the ego's remaining route that is examined [m]
  double sample_spacing = 4.0;          ///< between examined points [m]
  double route_length = 160.0;          ///< least length of the conflict-aware route [m]
  double distance_sigma = 10.0;         ///< sigma_s of the score [m]
  double time_sigma = 2.0;              ///< sigma_T of the score [s]
  double nearness_length = 40.0;        ///< l of the score [m]
  double minimum_speed = 2.0;           ///< v_min of arrival times [m/s]
  double first_time = 2.6;              ///< no selection before [s]
  double period = 0.2;                  ///< between selections [s]
  std::string life_cycle =
      "rift";               ///< rift | reselect: release on a lost conflict, with hysteresis
  double hysteresis = 0.1;  ///< reselect: a challenger's score must be better by this
  double lost_conflict_time = 2.0;  ///< reselect: released after this long without a conflict [s]

  void describe(core::OptionsVisitor& visitor);
  /// Throws InputError naming the key, its value and what is allowed.
  void validate() const;
};

// Fixed words that say why a vehicle is not a CBV, in the order in which the gates are tried.

/// It was a CBV before (life cycle "rift").
inline constexpr const char* kAlreadyChosen = "already_chosen";
/// It touches another vehicle and is about to be removed.
inline constexpr const char* kInContact = "in_contact";
/// Farther than search_radius from the ego.
inline constexpr const char* kTooFar = "too_far";
/// Nearer than minimum_distance to the ego.
inline constexpr const char* kTooNear = "too_near";
/// Above or below the ego.
inline constexpr const char* kOtherLevel = "other_level";
/// Its preview point lies on no lane, or no lane here has its direction.
inline constexpr const char* kOffLane = "off_lane";
/// In a junction, askew to the lanes below it.
inline constexpr const char* kJunctionHeading = "junction_heading";
/// No point of the ego's route lies near and ahead of it.
inline constexpr const char* kOutOfView = "out_of_view";
/// No lane-connected route of useful length leads to such a point.
inline constexpr const char* kNoWay = "no_way";
/// The distances to drive differ by route_distance_gate or more at all points.
inline constexpr const char* kDistanceMismatch = "distance_mismatch";
/// It has a conflict, but found no slot.
inline constexpr const char* kOutranked = "outranked";

// Gates that a vehicle passes before conflicts are searched: near the ego, on its level, and
// properly on a lane (RIFT's rules 2 to 4).

/// Where a vehicle is among the lanes; `reason` is null when it stands properly on one.
struct LanePlacement {
  const char* reason = nullptr;
  map::LanePosition place;
};

/// The point that must lie on a lane, `distance` [m] ahead of a vehicle's center, map frame [m].
inline Eigen::Vector2d previewPoint(const traffic::VehicleState& state, double distance) {
  return state.position + distance * geometry::direction(state.heading);
}

/// First gate of nearness and level that `vehicle` fails, or nullptr.
const char* failedNearness(const traffic::Vehicle& vehicle, const traffic::Vehicle& ego,
                           const CbvOptions& options);

/// The vehicle's own lane: the one SUMO names when its center lies there, else the nearest of its
/// direction. The preview point must lie on a lane, and inside a junction along one.
LanePlacement placeOnLane(const map::RoadNetwork& network, const traffic::Vehicle& vehicle,
                          const CbvOptions& options);

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
