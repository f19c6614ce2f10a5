// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <string>

#include "cbv/conflict_search.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::cbv {

// Reasons of release, besides kOutranked (life cycle "reselect": a better candidate took the slot).

/// It touched another vehicle.
inline constexpr const char* kContact = "contact";
/// It reached the end of its conflict-aware route.
inline constexpr const char* kRouteEnd = "route_end";
/// It is not in the snapshot any more.
inline constexpr const char* kGone = "gone";
/// Life cycle "reselect": no conflict for lost_conflict_time.
inline constexpr const char* kConflictLost = "conflict_lost";

/// Arc length [m] reached on a path by a vehicle that was at `arc_length`: looks as far ahead as
/// map::kRouteWindow, and along the whole rest of the path when the vehicle is more than `far_off`
/// meters from what lies there (it was not followed continuously). Never less than `arc_length`.
double advancedArcLength(const geometry::Polyline& path, double arc_length,
                         const Eigen::Vector2d& position, double far_off = 30.0);

/// Whether a contact of this tick involves the vehicle.
bool inContact(const traffic::TrafficSnapshot& snapshot, const std::string& vehicle_id);

/// A CBV in its slot: how far it has come along its conflict-aware route, and when it must leave
/// the slot.
class HeldCbv {
 public:
  /// `assignment` as selected; `conflict_arc_length` of the conflict point on its conflict-aware
  /// route [m].
  HeldCbv(CbvAssignment assignment, double conflict_arc_length);

  const CbvAssignment& assignment() const { return assignment_; }
  const std::string& vehicleId() const { return assignment_.vehicle_id; }

  /// Moves along the route; distances and times of the conflict point as of this snapshot, 0 once
  /// passed.
  void update(const traffic::Vehicle& vehicle, const EgoProgress& ego, double minimum_speed);
  /// Reason to release in every life cycle, or nullptr.
  const char* releaseReason(const traffic::TrafficSnapshot& snapshot) const;

  /// Present score, for the life cycle "reselect"; nullopt = no conflict at `time` [s].
  void setPresentScore(std::optional<double> score, double time);
  double presentScore() const { return present_score_; }
  /// Time without a conflict up to `time` [s].
  double lostTime(double time) const { return lost_since_ ? time - *lost_since_ : 0.0; }

 private:
  double remaining() const { return assignment_.conflict_aware_route.length() - arc_length_; }

  CbvAssignment assignment_;
  double conflict_arc_length_;
  double selected_distance_;  ///< along lanes, from where it was selected to the conflict point [m]
  double arc_length_ = 0.0;
  double present_score_;
  std::optional<double> lost_since_;
};

}  // namespace cdiff::cbv
