// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "e2e_cdiff/cbv/cbv_selection.h"
#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "map/lane_graph.h"

namespace cdiff::cbv {

/// Options of CBV identification; defaults: RIFT's rule.yaml in evaluation.
struct CbvOptions {
  std::vector<std::string> only;        ///< ids of the vehicles that may be taken; empty: all
  std::string ranking = "score";        ///< score | nearest | gates
  double search_radius = 60.0;          ///< ego center to candidate center [m]
  double minimum_distance = 10.0;       ///< [m]
  double interaction_radius = 90.0;     ///< candidate to a point of the ego's route, straight [m]
  double field_of_view = 150.0;         ///< full angle in which that point must lie [deg]
  double route_distance_gate = 20.0;    ///< largest |s_cbv - s_ego| at the conflict point [m]
  double preview_distance = 2.0;        ///< ahead of the candidate's center, must lie on a lane [m]
  double junction_heading_gate = 20.0;  ///< in a junction: vehicle against lane heading [deg]
  double queue_speed =
      0.5;                  ///< slower on a lane of the ego's route: queued; 0: all are taken [m/s]
  double clear_time = 1.0;  ///< no contact ahead for so long when it is taken over [s]
  double ego_route_length = 200.0;     ///< part of the ego's remaining route that is examined [m]
  double sample_spacing = 4.0;         ///< between examined points [m]
  double route_length = 160.0;         ///< least length of the conflict-aware route [m]
  double distance_sigma = 10.0;        ///< sigma_s of the score [m]
  double time_sigma = 2.0;             ///< sigma_T of the score [s]
  double nearness_length = 40.0;       ///< l of the score [m]
  double minimum_speed = 2.0;          ///< v_min of arrival times [m/s]
  double first_time = 2.6;             ///< no selection before [s]
  double period = 0.2;                 ///< between selections [s]
  std::string life_cycle = "by_mode";  ///< rift | reselect: release on a lost conflict, with
                                       ///< hysteresis | by_mode: reselect in challenging, else rift
  double hysteresis = 0.1;             ///< reselect: a challenger's score must be better by this
  double lost_conflict_time = 2.0;  ///< reselect: released after this long without a conflict [s]

  /// The same with the life cycle of a mode in the place of by_mode.
  CbvOptions inMode(const std::string& mode) const;
  void describe(core::OptionsVisitor& visitor);
  /// Throws InputError naming the key, its value and what is allowed.
  void validate() const;
};

}  // namespace cdiff::cbv
