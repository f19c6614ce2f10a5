// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The figures of a session, each with its unit, count and, where it cannot be given, the reason.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>

namespace cdiff::metrics {

/// One figure.
struct Measure {
  std::optional<double> value;  ///< absent when n is too small or the figure is undefined
  std::size_t n = 0;            ///< samples it stands on
  std::string unit;             ///< "m/s", "%", "s", "" ...
  std::string reason;  ///< why the value is absent, or how its samples were thinned out; else empty
};

/// Mean, standard deviation (n - 1) and minimum of defined samples.
struct DistributionMeasure {
  Measure mean;
  Measure standard_deviation;
  Measure minimum;
};

struct SessionMeasures {
  // Ego.
  double route_completion_percent = 0.0;
  double driving_score = 0.0;
  std::size_t ego_collisions = 0;  ///< contacts of the ego, charged or not
  std::string protocol;            ///< preset whose rules the score and the infractions follow
  bool blocked = false;            ///< the session ended because the ego stood still
  Measure penalty;                 ///< of the infractions, in [0, 1]
  std::map<std::string, Measure> infractions;  ///< by name, see EgoInfractions::measures
  Measure ego_off_road_percent;  ///< share of ticks with the ego's centre off the drivable area
  // CBVs, all slots together.
  std::size_t cbv_count = 0;           ///< vehicles that were driven as CBV
  std::size_t cbv_decisions = 0;       ///< decisions with a CBV driven, summed over CBVs
  Measure cbv_off_road_rate_percent;   ///< paper's ORR: centre off the drivable area / time as CBV
  std::size_t cbv_collisions = 0;      ///< contacts of CBVs with anyone
  std::size_t cbv_ego_collisions = 0;  ///< of these, with the ego
  Measure collisions_per_km;           ///< paper's CPK
  double cbv_distance_m = 0.0;
  Measure cbv_speed_error;       ///< mean |v - min(target speed, lane limit)| at decisions [m/s]
  Measure cbv_closest_distance;  ///< mean over CBVs of the smallest centre distance to the ego [m]
  Measure cbv_minimum_distance;  ///< the smallest of these [m]
  // Interaction.
  DistributionMeasure ttc_2d;  ///< ego against every other vehicle, per-decision minimum over those
                               ///< where defined [s]
  Measure speed_shapiro_wilk;  ///< W of CBV speeds
  Measure acceleration_shapiro_wilk;  ///< W of CBV accelerations
  Measure speed_wasserstein;  ///< W1 of CBV speeds to those of background vehicles of the same
                              ///< session [m/s]
  /// The same by RIFT's definitions: ttc_2d_s, speed_shapiro_wilk, acceleration_shapiro_wilk,
  /// speed_wasserstein_mps ...
  std::map<std::string, Measure> rift_compat;
};

}  // namespace cdiff::metrics
