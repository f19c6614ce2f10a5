// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The figures of a session, each with its unit, count and, where it cannot be given, the reason.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace cdiff::metrics {

/// One figure.
struct Measure {
  std::optional<double> value;  ///< absent when n is too small or the figure is undefined
  std::size_t n = 0;            ///< samples it stands on
  std::string unit;             ///< "m/s", "%", "s", "" ...
  std::string reason;  ///< why the value is absent, or how its samples were thinned out; else empty
  std::string target = {};  ///< what the samples are compared with; empty where with nothing
};

/// Mean, standard deviation (n - 1) and minimum of defined samples.
struct DistributionMeasure {
  Measure mean;
  Measure standard_deviation;
  Measure minimum;
};

/// Post-encroachment time of the ego and one CBV.
struct PostEncroachment {
  std::string vehicle_id;
  std::optional<double> seconds;  ///< absent when the two never came to one place in time [s]
  bool ego_first = false;         ///< whether the ego left the place before the CBV entered it
  std::string reason;             ///< why it is absent; else empty
};

/// A contact of the ego and who is at fault (contact_fault.h).
struct EgoContact {
  std::uint64_t tick = 0;  ///< first tick with overlap
  double seconds = 0.0;    ///< its time [s]
  std::string partner;     ///< id of the other vehicle
  bool ego_at_fault = false;
  std::string reason;          ///< why, in a short sentence
  double ego_speed = 0.0;      ///< at that tick [m/s]
  double partner_speed = 0.0;  ///< [m/s]
  std::string ego_side;        ///< "front", "rear", "left side", "right side"; empty: not known
  std::string partner_side;
  double x = 0.0;  ///< of the contact, map frame [m]
  double y = 0.0;  ///< [m]
};

/// Every number here that is published has a row in figure_definitions.h.
struct SessionMeasures {
  // Ego.
  double route_completion_percent = 0.0;
  double driving_score = 0.0;
  std::size_t ego_collisions = 0;        ///< contacts of the ego, charged or not
  std::vector<EgoContact> ego_contacts;  ///< each of them, in order of time
  std::string protocol;  ///< preset whose rules the score and the infractions follow
  bool blocked = false;  ///< the session ended because the ego stood still
  Measure penalty;       ///< of the infractions, in [0, 1]
  std::map<std::string, Measure> infractions;  ///< by name, see EgoInfractions::measures
  Measure ego_off_road_percent;  ///< share of ticks with the ego's centre off the drivable area
  // CBVs, all slots together.
  std::size_t cbv_count = 0;          ///< vehicles that were driven as CBV
  std::size_t cbv_decisions = 0;      ///< decisions with a CBV driven, summed over CBVs
  Measure cbv_off_road_rate_percent;  ///< paper's ORR: centre off the drivable area / time as CBV
  Measure cbv_corner_off_road_rate_percent;  ///< the same with any corner of the box off it
  Measure cbv_uncomfortable_rate_percent;    ///< decisions beyond nuPlan's comfort limits
  std::size_t cbv_collisions = 0;            ///< contacts of CBVs with anyone
  std::size_t cbv_ego_collisions = 0;        ///< of these, with the ego
  Measure collisions_per_km;                 ///< paper's CPK
  Measure ego_collisions_per_km;             ///< the same of contacts with the ego alone
  double cbv_distance_m = 0.0;
  Measure cbv_speed_error;       ///< mean |v - min(target speed, lane limit)| at decisions [m/s]
  Measure cbv_closest_distance;  ///< mean over CBVs of the smallest centre distance to the ego [m]
  Measure cbv_minimum_distance;  ///< the smallest of these [m]
  // Interaction.
  DistributionMeasure ttc_2d;  ///< ego against every other vehicle, per-decision minimum over those
                               ///< where defined [s]
  DistributionMeasure ttc_2d_cbv;         ///< the same, CBVs alone [s]
  DistributionMeasure ttc_lon_lat;        ///< the paper's wording, every other vehicle [s]
  Measure ttc_2d_defined_percent;         ///< decisions at which ttc_2d is defined [%]
  Measure ttc_2d_cbv_defined_percent;     ///< of decisions with a CBV [%]
  Measure ttc_lon_lat_defined_percent;    ///< [%]
  DistributionMeasure post_encroachment;  ///< over CBVs that have one [s]
  std::vector<PostEncroachment> post_encroachments;  ///< of every CBV, by id
  // Motion of CBVs at decisions.
  DistributionMeasure cbv_speed;         ///< [m/s]
  DistributionMeasure cbv_acceleration;  ///< magnitude, lateral part included [m/s^2]
  DistributionMeasure cbv_jerk;          ///< change of that magnitude in time [m/s^3]
  Measure speed_shapiro_wilk;            ///< W of CBV speeds
  Measure speed_shapiro_wilk_p;
  Measure acceleration_shapiro_wilk;  ///< W of signed CBV accelerations along the heading
  Measure acceleration_shapiro_wilk_p;
  Measure speed_wasserstein;  ///< W1 of CBV speeds to its `target` [m/s]
  /// The same by RIFT's definitions: ttc_2d_s, speed_shapiro_wilk, acceleration_shapiro_wilk,
  /// speed_wasserstein_mps ... (RiftMeasures::measures).
  std::map<std::string, Measure> rift_compat;

  /// How many of the ego's contacts are its fault.
  std::size_t contactsAtFault() const {
    return static_cast<std::size_t>(
        std::count_if(ego_contacts.begin(), ego_contacts.end(),
                      [](const EgoContact& contact) { return contact.ego_at_fault; }));
  }
};

}  // namespace cdiff::metrics
