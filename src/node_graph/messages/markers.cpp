// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/messages/markers.h"

#include <algorithm>
#include <optional>

#include "core/text.h"
#include "metrics/formulas/ttc_2d.h"
#include "node_graph/messages/marker_parts.h"
#include "node_graph/messages/plan_markers.h"

namespace cdiff::node_graph {
namespace {

using traffic::Vehicle;
using traffic::VehicleRole;
using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;
using Markers = std::vector<Marker>;

constexpr double kTrailTime = 4.0;     // [s]
constexpr double kContactTime = 3.0;   // [s] that a contact stays
constexpr double kTrailLift = 0.14;    // [m] above the road
constexpr double kLabelBeside = 1.9;   // [m] from a vehicle's box, toward +y of the map
constexpr double kDrivenLabel = 2.4;   // [m] height of a capital
constexpr double kTrafficLabel = 1.6;  // [m]
constexpr double kEventLabel = 2.0;    // [m]
constexpr double kLabelHeight = 4.0;   // [m] of labels above the road: above all boxes
constexpr double kSoon = 5.0;          // [s] to a collision with a vehicle that is no CBV
constexpr double kNear = 60.0;         // [m] of centers

std::string seconds(double value) { return core::formatFixed(value, 1) + " s"; }

std::string labelText(const Vehicle& vehicle) {
  const std::string speed = core::formatFixed(vehicle.state.speed, 1);
  if (vehicle.role == VehicleRole::kEgo) return "EGO  " + speed + " m/s";
  if (vehicle.role == VehicleRole::kCbv) return "CBV " + vehicle.id + "  " + speed + " m/s";
  return vehicle.id + "  " + speed;
}

Eigen::Vector3d besideVehicle(const Vehicle& vehicle, double sign) {
  const double reach = geometry::halfExtent(vehicle.box(), Eigen::Vector2d::UnitY()) + kLabelBeside;
  return onVehicle(vehicle, {0.0, 0.0, kLabelHeight}) + Eigen::Vector3d(0.0, sign * reach, 0.0);
}

void reserveVehicle(const Vehicle& vehicle, LabelRoom& room) {
  const geometry::OrientedBox box = vehicle.box();
  room.reserve(box.center, {geometry::halfExtent(box, Eigen::Vector2d::UnitX()),
                            geometry::halfExtent(box, Eigen::Vector2d::UnitY())});
}

/// An arrowhead on the roof that points ahead.
void addHeading(const Vehicle& vehicle, Marker& list) {
  const double front = 0.42 * vehicle.dimensions.length;
  const double back = 0.05 * vehicle.dimensions.length;
  const double half = 0.42 * vehicle.dimensions.width;
  const double roof = vehicle.dimensions.height + 0.05;
  addTriangle(list, onVehicle(vehicle, {front, 0.0, roof}), onVehicle(vehicle, {back, half, roof}),
              onVehicle(vehicle, {back, -half, roof}), marker_color::kWhite);
}

void addOutline(const Vehicle& vehicle, Marker& list) {
  const double ahead = 0.5 * vehicle.dimensions.length;
  const double side = 0.5 * vehicle.dimensions.width;
  const double roof = vehicle.dimensions.height + 0.03;
  const Eigen::Vector3d corners[4] = {
      onVehicle(vehicle, {ahead, side, roof}), onVehicle(vehicle, {ahead, -side, roof}),
      onVehicle(vehicle, {-ahead, -side, roof}), onVehicle(vehicle, {-ahead, side, roof})};
  const MarkerColor& color =
      vehicle.role == VehicleRole::kBackground ? marker_color::kPlate : marker_color::kWhite;
  for (std::size_t i = 0; i < 4; ++i) addSegment(list, corners[i], corners[(i + 1) % 4], color);
}

void addConflicts(const cbv::CbvSelection& selection, LabelRoom& room, Markers& markers) {
  Labels labels("conflict_labels", &room);
  for (const cbv::CbvAssignment& assignment : selection.assignments) {
    const cbv::ConflictPoint& conflict = assignment.conflict_point;
    Marker ball =
        makeMarker("conflict_points", assignment.slot, Marker::CYLINDER, marker_color::kConflict);
    ball.pose.position = toMarkerPoint(conflict.position, 0.2);
    ball.scale.x = ball.scale.y = 2.4;
    ball.scale.z = 0.1;
    markers.push_back(ball);
    room.reserve(conflict.position.head<2>(), {1.2, 1.2});
    labels.add(assignment.slot,
               "conflict point: ego in " + seconds(conflict.ego_arrival) + ", " +
                   assignment.vehicle_id + " in " + seconds(conflict.cbv_arrival),
               conflict.position + Eigen::Vector3d(0.0, -3.0 - 3.0 * assignment.slot, kLabelHeight),
               kEventLabel, marker_color::kConflict);
    if (assignment.conflict_aware_route.empty()) continue;
    const MarkerColor& cbv = marker_color::kCbv;
    appendMarkers(markers, routeMarkers("conflict_aware_routes", assignment.slot,
                                        assignment.conflict_aware_route, marker_color::kCbvRoute));
    const Eigen::Vector3d goal = assignment.conflict_aware_route.path().points().back();
    Marker disc = makeMarker("cbv_goals", assignment.slot, Marker::CYLINDER, cbv);
    disc.pose.position = toMarkerPoint(goal, 0.15);
    disc.scale.x = disc.scale.y = 3.0;
    disc.scale.z = 0.1;
    markers.push_back(disc);
    labels.add(100 + assignment.slot, "goal of " + assignment.vehicle_id,
               goal + Eigen::Vector3d(0.0, -3.4, kLabelHeight), kEventLabel, cbv);
  }
  appendMarkers(markers, labels.markers());
}

/// What CBVs intend, in words, beside the ends of their plans.
void addIntentions(const std::vector<planning::PlannedAction>& actions, LabelRoom& room,
                   Markers& markers) {
  constexpr double kBeside = 3.0;  // [m]
  Labels labels("plan_labels", &room);
  for (const planning::PlannedAction& action : actions) {
    if (action.slot == traffic::kEgoSlot || action.rollout.empty()) continue;
    const traffic::VehicleState& end = action.rollout.back().state;
    const Eigen::Vector3d place(end.position.x(), end.position.y() + kBeside,
                                end.elevation + kLabelHeight);
    labels.add(2 * action.slot, intentionText(action), place, kEventLabel, planColor(action));
    const std::string challenge = challengeText(action);
    if (challenge.empty()) continue;
    labels.add(2 * action.slot + 1, challenge, place, kEventLabel, marker_color::kWhite);
  }
  appendMarkers(markers, labels.markers());
}

MarkerColor urgency(const std::optional<double>& time) {
  if (!time || *time > kSoon) return marker_color::kSoft;
  return *time < 1.5 ? marker_color::kEgo : marker_color::kConflict;
}

/// The ego and each CBV, and others that it would soon touch, if all kept speed and direction.
void addTimesToCollision(const traffic::TrafficSnapshot& snapshot, LabelRoom& room,
                         Markers& markers) {
  const Vehicle* ego = snapshot.ego();
  if (ego == nullptr) return;
  Marker lines = makeMarker("ttc", 0, Marker::LINE_LIST, marker_color::kSoft);
  lines.scale.x = 0.12;
  Labels labels("ttc_labels", &room);
  int id = 0;
  for (const Vehicle& other : snapshot.vehicles) {
    const double distance = (other.state.position - ego->state.position).norm();
    if (&other == ego || distance > kNear || traffic::onDifferentLevels(*ego, other)) continue;
    const auto time = metrics::timeToCollision2d({ego->box(), ego->state.velocity()},
                                                 {other.box(), other.state.velocity()});
    const bool cbv = other.role == VehicleRole::kCbv;
    if (!cbv && !(time && *time < kSoon)) continue;
    const Eigen::Vector3d from = onVehicle(*ego, {0.0, 0.0, 2.0});
    const Eigen::Vector3d to = onVehicle(other, {0.0, 0.0, 2.0});
    const MarkerColor color = urgency(time);
    addSegment(lines, from, to, color);
    const std::string gap = core::formatFixed(geometry::distance(ego->box(), other.box()), 1);
    labels.add(id++,
               (time ? "TTC " + seconds(*time) : std::string("no collision course")) + ", gap " +
                   gap + " m",
               0.5 * (from + to) + Eigen::Vector3d(0.0, 0.0, kLabelHeight - 2.0), kTrafficLabel,
               color);
  }
  if (!lines.points.empty()) markers.push_back(lines);
  appendMarkers(markers, labels.markers());
}

}  // namespace

SessionMarkers::SessionMarkers(const session::SessionSetup& setup) : signals_(setup.network()) {}

int SessionMarkers::idOf(const std::string& vehicle_id) {
  return ids_.try_emplace(vehicle_id, static_cast<int>(ids_.size())).first->second;
}

void SessionMarkers::note(const traffic::TrafficSnapshot& snapshot) {
  while (!contacts_.empty() && contacts_.front().begin + kContactTime < snapshot.time)
    contacts_.pop_front();
  for (const traffic::Contact& contact : snapshot.contacts) {
    const Vehicle* first = snapshot.find(contact.first);
    const Vehicle* second = snapshot.find(contact.second);
    if (first == nullptr || second == nullptr) continue;
    const Eigen::Vector3d place =
        0.5 * (onVehicle(*first, {0.0, 0.0, 2.2}) + onVehicle(*second, {0.0, 0.0, 2.2}));
    contacts_.push_back(
        {snapshot.time, place,
         "CONTACT " + contact.first + " and " + contact.second + " at " + seconds(snapshot.time)});
  }
}

void SessionMarkers::addVehicles(const traffic::TrafficSnapshot& snapshot, LabelRoom& room,
                                 Markers& markers) {
  Marker headings = makeMarker("headings", 0, Marker::TRIANGLE_LIST, marker_color::kWhite);
  Marker outlines = makeMarker("outlines", 0, Marker::LINE_LIST, marker_color::kWhite);
  outlines.scale.x = 0.16;
  Labels driven("labels", &room);
  Labels others("traffic_labels", &room);
  for (const Vehicle& vehicle : snapshot.vehicles) {
    const int id = idOf(vehicle.id);
    const MarkerColor& color = markerColorOf(vehicle.role);
    markers.push_back(boxMarker("vehicles", id, vehicle, color));
    addHeading(vehicle, headings);
    addOutline(vehicle, outlines);
    const bool traffic = vehicle.role == VehicleRole::kBackground;
    (traffic ? others : driven)
        .add(id, labelText(vehicle), besideVehicle(vehicle, 1.0),
             traffic ? kTrafficLabel : kDrivenLabel, traffic ? marker_color::kWhite : color);
  }
  if (!headings.points.empty()) appendMarkers(markers, {headings, outlines});
  appendMarkers(markers, others.markers());
  appendMarkers(markers, driven.markers());
}

/// The older the fainter.
void SessionMarkers::addTrails(const traffic::TrafficSnapshot& snapshot, Markers& markers) {
  for (auto trail = trails_.begin(); trail != trails_.end();)
    trail = snapshot.find(trail->first) == nullptr ? trails_.erase(trail) : std::next(trail);
  Marker lines = makeMarker("trails", 0, Marker::LINE_LIST, marker_color::kWhite);
  lines.scale.x = 0.35;
  for (const Vehicle& vehicle : snapshot.vehicles) {
    if (vehicle.role == VehicleRole::kBackground) continue;
    Trail& trail = trails_[vehicle.id];
    trail.emplace_back(snapshot.time, onVehicle(vehicle, {0.0, 0.0, kTrailLift}));
    while (trail.front().first + kTrailTime < snapshot.time) trail.pop_front();
    MarkerColor color = markerColorOf(vehicle.role);
    for (std::size_t i = 1; i < trail.size(); ++i) {
      const double age = (snapshot.time - trail[i].first) / kTrailTime;
      color.alpha = static_cast<float>(0.9 * (1.0 - age));
      addSegment(lines, trail[i - 1].second, trail[i].second, color);
    }
  }
  if (!lines.points.empty()) markers.push_back(lines);
}

void SessionMarkers::addContacts(LabelRoom& room, Markers& markers) const {
  Labels labels("contact_labels", &room);
  int id = 0;
  for (const ShownContact& contact : contacts_) {
    Marker ball = makeMarker("contacts", id, Marker::SPHERE, marker_color::kContact);
    ball.pose.position = toMarkerPoint(contact.place);
    ball.scale.x = ball.scale.y = 2.0;
    ball.scale.z = 0.6;
    markers.push_back(ball);
    labels.add(id++, contact.text, contact.place + Eigen::Vector3d(0.0, -4.5, 2.0), kDrivenLabel,
               marker_color::kContact);
  }
  appendMarkers(markers, labels.markers());
}

/// A stop line in its light's color.
void SessionMarkers::addSignals(const traffic::TrafficSnapshot& snapshot, Markers& markers) {
  constexpr MarkerColor kLamps[] = {marker_color::kWhite,
                                    {1.0F, 0.15F, 0.10F, 1.0F},
                                    {1.0F, 0.80F, 0.10F, 1.0F},
                                    {0.15F, 0.95F, 0.35F, 1.0F}};
  Marker lines = makeMarker("signals", 0, Marker::LINE_LIST, marker_color::kWhite);
  lines.scale.x = 0.7;
  const std::vector<rendering::LampColor> colors = signals_.colorsOf(snapshot.signals);
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const rendering::SignalHead& head = signals_.heads()[i];
    const Eigen::Vector2d left = geometry::leftNormal(head.forward) * (0.5 * head.width - 0.1);
    const Eigen::Vector3d side(left.x(), left.y(), 0.0);
    const Eigen::Vector3d middle = head.stop + Eigen::Vector3d(0.0, 0.0, 0.08);
    addSegment(lines, middle - side, middle + side, kLamps[static_cast<int>(colors[i])]);
  }
  if (!lines.points.empty()) markers.push_back(lines);
}

/// Below each vehicle that was looked at and not taken: its score, or why not.
void SessionMarkers::addCandidates(const traffic::TrafficSnapshot& snapshot,
                                   const cbv::CbvSelection& selection, LabelRoom& room,
                                   Markers& markers) {
  Labels labels("candidates", &room);
  for (const cbv::RejectedCandidate& candidate : selection.rejected) {
    const Vehicle* vehicle = snapshot.find(candidate.vehicle_id);
    if (vehicle == nullptr) continue;
    const bool scored = candidate.interaction_score > 0.0;
    const std::string score = core::formatFixed(candidate.interaction_score, 2) + " ";
    labels.add(idOf(vehicle->id), (scored ? score : "") + candidate.reason,
               besideVehicle(*vehicle, -1.0), kTrafficLabel, marker_color::kSoft);
  }
  for (const cbv::CbvAssignment& assignment : selection.assignments) {
    const Vehicle* vehicle = snapshot.find(assignment.vehicle_id);
    if (vehicle == nullptr) continue;
    labels.add(idOf(vehicle->id),
               "slot " + std::to_string(assignment.slot) + ", score " +
                   core::formatFixed(assignment.interaction_score, 2),
               besideVehicle(*vehicle, -1.0), kTrafficLabel, marker_color::kCbv);
  }
  appendMarkers(markers, labels.markers());
}

MarkerArray SessionMarkers::build(const session::TickRecord& record) {
  const traffic::TrafficSnapshot& snapshot = *record.snapshot;
  const cbv::CbvSelection* selection = record.selection;
  MarkerArray array;
  LabelRoom room;
  for (const Vehicle& vehicle : snapshot.vehicles) reserveVehicle(vehicle, room);
  addSignals(snapshot, array.markers);
  addTrails(snapshot, array.markers);
  addVehicles(snapshot, room, array.markers);
  addContacts(room, array.markers);
  if (selection != nullptr) addConflicts(*selection, room, array.markers);
  if (record.actions != nullptr) addIntentions(*record.actions, room, array.markers);
  addTimesToCollision(snapshot, room, array.markers);
  if (selection != nullptr) addCandidates(snapshot, *selection, room, array.markers);
  dateMarkers(array.markers, snapshot.time);
  if (first_) array.markers.insert(array.markers.begin(), deleteAllMarkers());
  first_ = false;
  return array;
}

}  // namespace cdiff::node_graph
