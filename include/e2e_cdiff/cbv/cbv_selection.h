// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "e2e_cdiff/map/route.h"

namespace cdiff::cbv {

/// Where the routes of ego and CBV meet, with the distances along each.
struct ConflictPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< map frame [m]
  double ego_arc_length = 0.0;                         ///< on the ego's route, from its start [m]
  double ego_distance = 0.0;                           ///< still to drive for the ego [m]
  double cbv_distance = 0.0;                           ///< still to drive for the CBV [m]
  double ego_arrival = 0.0;  ///< [s] from now at its present speed (at least v_min)
  double cbv_arrival = 0.0;  ///< [s]
  /// How much later the CBV arrives than the ego; negative: earlier [s].
  double arrivalTimeGap() const { return cbv_arrival - ego_arrival; }
};

/// A vehicle in a slot.
struct CbvAssignment {
  int slot = 0;                     ///< number of the slot
  std::string vehicle_id;           ///< vehicle in it
  double interaction_score = 0.0;   ///< at selection, in [0, 1]
  std::uint64_t selected_tick = 0;  ///< tick at which it was selected
  ConflictPoint conflict_point;  ///< position as selected, distances and times as of this decision
  map::Route
      conflict_aware_route;  ///< from where it was selected, through the conflict point, and on
};

/// A candidate that was not taken. Reasons are fixed words (docs/cbv_identification.md).
struct RejectedCandidate {
  std::string vehicle_id;          ///< the candidate
  std::string reason;              ///< why it was not taken
  double interaction_score = 0.0;  ///< 0 when rejected before scoring
};

/// A slot that became free at this decision.
struct ReleasedCbv {
  int slot = 0;            ///< number of the slot
  std::string vehicle_id;  ///< vehicle that was in it
  std::string reason;      ///< "contact", "gone", ...; "outranked" in life cycle "reselect"
};

/// What CBV identification says at one decision: which vehicles are critical, where they conflict
/// with the ego, and why every other vehicle is not (paper III-B).
struct CbvSelection {
  std::uint64_t tick = 0;                   ///< tick of the decision
  std::vector<CbvAssignment> assignments;   ///< by slot
  std::vector<RejectedCandidate> rejected;  ///< by id
  std::vector<ReleasedCbv> released;        ///< by slot

  /// The vehicle in a slot, or nullptr.
  const CbvAssignment* find(int slot) const;
};

}  // namespace cdiff::cbv
