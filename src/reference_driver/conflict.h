// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <limits>

#include "reference_driver/driven_path.h"

namespace cdiff::reference_driver {

// How another vehicle comes into a driver's way, if both keep their velocities along and across the
// driver's path (SI units). The corridor is the strip that the driver's box sweeps.

/// Kinds of conflict, by the angle of the other's velocity to the path.
enum class ConflictKind {
  kLead,      ///< it is in the corridor, ahead, and does not come back
  kCutIn,     ///< from beside, within 30 degrees of the path
  kMerge,     ///< from beside, 30 to 60 degrees
  kCrossing,  ///< 60 to 120 degrees
  kOncoming   ///< beyond 120 degrees
};

/// "lead", "cut_in", "merge", "crossing" or "oncoming".
const char* toText(ConflictKind kind);

/// The times, counted from now [s], between which something holds. It is empty where the end is not
/// after the beginning.
struct TimeSpan {
  double begin = 0.0;
  double end = -1.0;

  bool empty() const { return !(end > begin); }
};

/// Two vehicles in each other's way.
struct Conflict {
  ConflictKind kind = ConflictKind::kLead;
  TimeSpan in_corridor;  ///< the other's box lies in the corridor
  TimeSpan beside;       ///< the two boxes are level with each other along the path
  double gap = 0.0;      ///< between the boxes along the path, positive: the other is ahead [m]
  bool ahead = false;    ///< its center is farther along the path
  /// Deceleration that stops the other before the corridor [m/s^2]; infinite where it is in there.
  double stops_before = std::numeric_limits<double>::infinity();
  double to_corridor = 0.0;  ///< across the path to the corridor [m]; negative: inside
};

/// The conflict of a driver at `speed` [m/s] (its own, or the one that it is about to have) with
/// another vehicle. One that cuts in or merges stays in the corridor.
Conflict conflictOf(const OwnMotion& own, double speed, const SeenVehicle& other);

/// Whether the two are in each other's way within `horizon`, or miss each other by less than
/// `arrival_gap` [s].
bool meets(const Conflict& conflict, double horizon, double arrival_gap);

}  // namespace cdiff::reference_driver
