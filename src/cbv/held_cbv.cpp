// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "cbv/held_cbv.h"

#include <algorithm>

#include "cbv/conflict_search.h"

namespace cdiff::cbv {

double advancedArcLength(const geometry::Polyline& path, double arc_length,
                         const Eigen::Vector2d& position, double far_off) {
  auto nearest = path.projectNear(position, arc_length, {0.0, map::kRouteWindow.ahead});
  if (nearest.distance > far_off) {
    const auto anywhere = path.project(position, arc_length, path.length());
    if (anywhere.distance <= far_off) nearest = anywhere;
  }
  return std::max(arc_length, nearest.arc_length);
}

bool inContact(const traffic::TrafficSnapshot& snapshot, const std::string& vehicle_id) {
  return std::any_of(snapshot.contacts.begin(), snapshot.contacts.end(), [&](const auto& contact) {
    return contact.first == vehicle_id || contact.second == vehicle_id;
  });
}

HeldCbv::HeldCbv(CbvAssignment assignment, double conflict_arc_length)
    : assignment_(std::move(assignment)),
      conflict_arc_length_(conflict_arc_length),
      selected_distance_(assignment_.conflict_point.cbv_distance),
      present_score_(assignment_.interaction_score) {}

void HeldCbv::update(const traffic::Vehicle& vehicle, const EgoProgress& ego,
                     double minimum_speed) {
  arc_length_ = advancedArcLength(assignment_.conflict_aware_route.path(), arc_length_,
                                  vehicle.state.position);
  ConflictPoint& point = assignment_.conflict_point;
  point.ego_distance = std::max(0.0, point.ego_arc_length - ego.arc_length);
  // The route rounds corners, so it is a little shorter than the lanes: scaled, the distance does
  // not jump.
  const double share_left = 1.0 - arc_length_ / conflict_arc_length_;
  point.cbv_distance = std::max(0.0, selected_distance_ * share_left);
  point.ego_arrival = arrivalTime(point.ego_distance, ego.state.speed, minimum_speed);
  point.cbv_arrival = arrivalTime(point.cbv_distance, vehicle.state.speed, minimum_speed);
}

const char* HeldCbv::releaseReason(const traffic::TrafficSnapshot& snapshot) const {
  constexpr double kEndDistance = 3.0;  // [m] from the end of the route
  constexpr double kArrivalDistance =
      10.0;  // [m] a vehicle that vanishes this near the end has arrived
  if (inContact(snapshot, vehicleId())) return kContact;
  const auto& removed = snapshot.removed;
  if (std::find(removed.begin(), removed.end(), vehicleId()) != removed.end()) {
    return remaining() <= kArrivalDistance ? kRouteEnd : kContact;
  }
  if (snapshot.find(vehicleId()) == nullptr) return kGone;
  return remaining() <= kEndDistance ? kRouteEnd : nullptr;
}

void HeldCbv::setPresentScore(std::optional<double> score, double time) {
  present_score_ = score.value_or(0.0);
  if (score) {
    lost_since_.reset();
  } else if (!lost_since_) {
    lost_since_ = time;
  }
}

}  // namespace cdiff::cbv
