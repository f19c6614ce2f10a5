// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// CBV identification (paper III-B): for every vehicle the best conflict point with the ego's remaining route by equal distance,
/// equal arrival time and nearness; the best candidates fill the slots and keep them (RIFT's life cycle by default).
#pragma once

#include <map>
#include <set>
#include <string>

#include "e2e_cdiff/cbv/cbv_selection.h"
#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/map/lane_graph.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::cbv {

/// Defaults: RIFT's rule.yaml in evaluation.
struct CbvOptions {
  std::string ranking = "score";          ///< score | nearest
  double search_radius = 60.0;            ///< ego centre to candidate centre [m]
  double minimum_distance = 10.0;         ///< [m]
  double interaction_radius = 90.0;       ///< candidate to a point of the ego's route, straight [m]
  double field_of_view = 150.0;           ///< full angle in which that point must lie [deg]
  double route_distance_gate = 20.0;      ///< largest |s_cbv - s_ego| at the conflict point [m]
  double preview_distance = 2.0;          ///< ahead of the candidate's centre, must lie on a lane [m]
  double junction_heading_gate = 20.0;    ///< in a junction: vehicle against lane heading [deg]
  double ego_route_length = 200.0;        ///< part of the ego's remaining route that is examined [m]
  double sample_spacing = 4.0;            ///< between examined points [m]
  double route_length = 160.0;            ///< least length of the conflict-aware route [m]
  double distance_sigma = 10.0;           ///< sigma_s of the score [m]
  double time_sigma = 2.0;                ///< sigma_T of the score [s]
  double nearness_length = 40.0;          ///< l of the score [m]
  double minimum_speed = 2.0;             ///< v_min of arrival times [m/s]
  double first_time = 2.6;                ///< no selection before [s]
  double period = 0.2;                    ///< between selections [s]
  std::string life_cycle = "rift";        ///< rift | reselect: release on a lost conflict, with hysteresis
  double hysteresis = 0.1;                ///< reselect: a challenger's score must be better by this
  double lost_conflict_time = 2.0;        ///< reselect: released after this long without a conflict [s]

  void describe(core::OptionsVisitor& visitor);
  void validate() const;
};

// Reasons of rejection.
inline constexpr const char* kTooFar = "too_far";
inline constexpr const char* kTooNear = "too_near";
inline constexpr const char* kOtherLevel = "other_level";
inline constexpr const char* kOffLane = "off_lane";
inline constexpr const char* kJunctionHeading = "junction_heading";
inline constexpr const char* kNoWay = "no_way";
inline constexpr const char* kOutOfView = "out_of_view";
inline constexpr const char* kDistanceMismatch = "distance_mismatch";
inline constexpr const char* kAlreadyChosen = "already_chosen";
inline constexpr const char* kOutranked = "outranked";

/// Not copyable; one per session; `update` once per decision in tick order.
class CbvSelector {
 public:
  /// Keeps references: graph and route must outlive the selector.
  CbvSelector(const CbvOptions& options, int max_cbv, const map::LaneGraph& graph, const map::Route& ego_route);

  /// The selection of this decision. A pure function of the snapshots seen so far.
  CbvSelection update(const traffic::TrafficSnapshot& snapshot);

 private:
  struct Candidate;
  CbvOptions options_;
  int max_cbv_;
  const map::LaneGraph& graph_;
  const map::Route& ego_route_;
  std::map<int, CbvAssignment> slots_;
  std::set<std::string> never_again_;
  double ego_arc_length_ = 0.0;
};

}  // namespace cdiff::cbv
