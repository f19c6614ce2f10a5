// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "cbv/cbv_options.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "map/lane_graph.h"

namespace cdiff::cbv {

// Fixed words that say why a vehicle is not a CBV, in the order in which the gates are tried.

/// CbvOptions::only does not name it.
inline constexpr const char* kNotNamed = "not_named";
/// A pedestrian, a bicycle or a small object: no planner of CBVs can drive it.
inline constexpr const char* kTooSmall = "too_small";
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
/// Stands on a lane of the ego's route: it waits in the same queue.
inline constexpr const char* kQueued = "queued";
/// In a junction, askew to the lanes below it.
inline constexpr const char* kJunctionHeading = "junction_heading";
/// No point of the ego's route lies near and ahead of it.
inline constexpr const char* kOutOfView = "out_of_view";
/// No lane-connected route of useful length leads to such a point.
inline constexpr const char* kNoWay = "no_way";
/// The distances to drive differ by route_distance_gate or more at all points.
inline constexpr const char* kDistanceMismatch = "distance_mismatch";
/// It would touch another vehicle within clear_time, whoever drives it.
inline constexpr const char* kContactAhead = "contact_ahead";
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

}  // namespace cdiff::cbv
