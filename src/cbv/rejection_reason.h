// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Fixed words that say why a vehicle is not a CBV, in the order in which the gates are tried.
#pragma once

namespace cdiff::cbv {

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
/// No lane-connected way of useful length leads to such a point.
inline constexpr const char* kNoWay = "no_way";
/// The distances to drive differ by route_distance_gate or more at all points.
inline constexpr const char* kDistanceMismatch = "distance_mismatch";
/// It has a conflict, but found no slot.
inline constexpr const char* kOutranked = "outranked";

}  // namespace cdiff::cbv
