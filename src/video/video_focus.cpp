// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "video/video_focus.h"

#include <cmath>

namespace cdiff::video {
namespace {

using traffic::Vehicle;

/// Gap of the boxes [m]; 0 without ego.
double gapTo(const Vehicle* ego, const Vehicle& vehicle) {
  if (ego == nullptr || !isPlaced(*ego)) return 0.0;
  return geometry::distance(ego->box(), vehicle.box());
}

}  // namespace

bool isPlaced(const Vehicle& vehicle) {
  return vehicle.state.position.allFinite() && std::isfinite(vehicle.state.heading) &&
         std::isfinite(vehicle.state.elevation);
}

const Vehicle* FollowedCbv::update(const traffic::TrafficSnapshot& snapshot) {
  const Vehicle* nearest = nullptr;
  const Vehicle* shown = nullptr;
  for (const Vehicle& vehicle : snapshot.vehicles) {
    if (vehicle.role != traffic::VehicleRole::kCbv || !isPlaced(vehicle)) continue;
    if (vehicle.id == id_) shown = &vehicle;
    const Vehicle* ego = snapshot.ego();
    if (nearest == nullptr || gapTo(ego, vehicle) < gapTo(ego, *nearest)) nearest = &vehicle;
  }
  if (nearest == nullptr) {
    id_.clear();
    return nullptr;
  }
  const Vehicle* ego = snapshot.ego();
  const bool stay = shown != nullptr && gapTo(ego, *shown) < gapTo(ego, *nearest) + kMargin;
  if (!stay) shown = nearest;
  id_ = shown->id;
  return shown;
}

ContactMarks::ContactMarks(const session::SessionSetup& setup)
    : ego_contacts_(&setup.network(), setup.metricsOptions().infractions.collision_minimum_speed) {}

void ContactMarks::update(const traffic::TrafficSnapshot& snapshot) {
  ego_contacts_.observe(snapshot);
  for (; seen_ < ego_contacts_.contacts().size(); ++seen_) {
    const metrics::EgoContact& contact = ego_contacts_.contacts()[seen_];
    const std::string fault = contact.ego_at_fault ? ": ego at fault" : ": ego not at fault";
    marks_.push_back({contact.seconds,
                      {contact.x, contact.y},
                      contact.partner,
                      contact.ego_at_fault,
                      "ego and " + contact.partner + fault,
                      contact.reason});
  }
  addOthers(snapshot);
  while (!marks_.empty() && marks_.front().begin < snapshot.time - kContactTime) marks_.pop_front();
}

void ContactMarks::addOthers(const traffic::TrafficSnapshot& snapshot) {
  const Vehicle* ego = snapshot.ego();
  for (const traffic::Contact& contact : snapshot.contacts) {
    if (ego != nullptr && (contact.first == ego->id || contact.second == ego->id)) continue;
    const Vehicle* first = snapshot.find(contact.first);
    const Vehicle* second = snapshot.find(contact.second);
    if (first == nullptr || second == nullptr || !isPlaced(*first) || !isPlaced(*second)) continue;
    ContactMark mark;
    mark.begin = snapshot.time;
    mark.position = 0.5 * (first->state.position + second->state.position);
    mark.label = contact.first + " and " + contact.second;
    marks_.push_back(mark);
  }
}

const ContactMark* ContactMarks::ofEgo() const {
  for (auto mark = marks_.rbegin(); mark != marks_.rend(); ++mark) {
    if (!mark->partner.empty()) return &*mark;
  }
  return nullptr;
}

}  // namespace cdiff::video
