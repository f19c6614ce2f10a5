// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "realism/recording_builder.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/text.h"
#include "realism/recording.h"

namespace cdiff::realism {

HandOverSelector::HandOverSelector(std::unique_ptr<cbv::VehicleSelector> inner, bool hands_over)
    : inner_(std::move(inner)), hands_over_(hands_over) {}

bool HandOverSelector::isFirst(const std::string& vehicle_id) const {
  return std::any_of(first_.begin(), first_.end(), [&](const cbv::CbvAssignment& assignment) {
    return assignment.vehicle_id == vehicle_id;
  });
}

cbv::CbvSelection HandOverSelector::update(const traffic::TrafficSnapshot& snapshot) {
  const cbv::CbvSelection all = inner_->update(snapshot);
  if (first_.empty()) first_ = all.assignments;
  cbv::CbvSelection kept;
  kept.tick = all.tick;
  if (!hands_over_) return kept;
  for (const cbv::CbvAssignment& assignment : all.assignments) {
    if (isFirst(assignment.vehicle_id)) kept.assignments.push_back(assignment);
  }
  for (const cbv::ReleasedCbv& released : all.released) {
    if (isFirst(released.vehicle_id)) kept.released.push_back(released);
  }
  return kept;
}

namespace {

constexpr std::size_t kHistory = 3;  // decisions up to the hand-over that differences reach back to

std::string csvText(double value) { return "," + core::formatNumber(value); }

bool collides(const traffic::TrafficSnapshot& snapshot, const traffic::Vehicle& vehicle) {
  return std::any_of(snapshot.vehicles.begin(), snapshot.vehicles.end(), [&](const auto& other) {
    return other.id != vehicle.id && !traffic::onDifferentLevels(vehicle, other) &&
           geometry::overlap(vehicle.box(), other.box());
  });
}

}  // namespace

void RecordingBuilder::add(const traffic::TrafficSnapshot& snapshot) {
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
    const traffic::VehicleState& state = vehicle.state;
    trackOf(vehicle).states.push_back({state.position, state.heading, state.elevation});
  }
  ++steps_;
}

void RecordingBuilder::noteContacts(const traffic::TrafficSnapshot& snapshot) {
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
    const auto found = latest_.find(vehicle.id);
    if (found == latest_.end() || !collides(snapshot, vehicle)) continue;
    Track& track = recording_.tracks[found->second];
    if (!by_role_ || track.role == traffic::toText(vehicle.role)) track.noteContact(steps_ - 1);
  }
}

Track& RecordingBuilder::trackOf(const traffic::Vehicle& vehicle) {
  std::vector<Track>& tracks = recording_.tracks;
  const std::string role = traffic::toText(vehicle.role);
  const auto [found, fresh] = latest_.try_emplace(vehicle.id, tracks.size());
  const bool goes_on = !fresh && tracks[found->second].end() == steps_ &&
                       (!by_role_ || tracks[found->second].role == role);
  if (!goes_on) {
    found->second = tracks.size();
    tracks.push_back(
        {vehicle.id, role, vehicle.dimensions.length, vehicle.dimensions.width, steps_, {}});
  }
  return tracks[found->second];
}

void SessionRecorder::observe(const session::TickRecord& record) {
  if (record.snapshot->decision_tick) builder_.add(*record.snapshot);
  builder_.noteContacts(*record.snapshot);
}

CourseRecorder::CourseRecorder(const session::SessionSetup& setup, const HandOverSelector& selector,
                               std::size_t steps, bool sumo_drives, std::atomic<bool>& stop)
    : setup_(setup), selector_(selector), steps_(steps), sumo_drives_(sumo_drives), stop_(stop) {}

void CourseRecorder::hash(const traffic::TrafficSnapshot& snapshot) {
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
    hash_.update(std::to_string(snapshot.tick) + "," + vehicle.id +
                 csvText(vehicle.state.position.x()) + csvText(vehicle.state.position.y()) +
                 csvText(vehicle.state.heading) + csvText(vehicle.state.speed) + "\n");
  }
}

void CourseRecorder::handOver(const traffic::TrafficSnapshot& snapshot) {
  found_.emplace();
  found_->hand_over_tick = snapshot.tick;
  found_->sha256 = hash_.finish();
  for (const traffic::TrafficSnapshot& earlier : before_) builder_.add(earlier);
  first_step_ = builder_.steps();
  for (const cbv::CbvAssignment& assignment : selector_.first()) {
    found_->objects.push_back(assignment.vehicle_id);
    objects_.push_back({assignment.vehicle_id,
                        {setup_.network(), assignment.conflict_aware_route,
                         setup_.options().protocol.infractions}});
  }
}

void CourseRecorder::observe(const session::TickRecord& record) {
  const traffic::TrafficSnapshot& snapshot = *record.snapshot;
  if (snapshot.status == traffic::SessionStatus::kError) {
    for (const traffic::Fault& fault : snapshot.faults) error_ += fault.source + ": " + fault.text;
  }
  if (stop_) return;
  if (!found_) {
    hash(snapshot);
    if (!snapshot.decision_tick) return;
    before_.push_back(snapshot);
    if (before_.size() > kHistory) before_.pop_front();
    if (!selector_.first().empty()) handOver(snapshot);
    return;
  }
  for (Object& object : objects_) note(snapshot, object);
  if (!snapshot.decision_tick) return;
  builder_.add(snapshot);
  for (Object& object : objects_) {
    const traffic::Vehicle* vehicle = find(snapshot, object);
    closeStep(vehicle == nullptr ? kNoValue : edgeDistance(*vehicle), object);
  }
  stop_ = builder_.steps() - first_step_ >= steps_;
}

const traffic::Vehicle* CourseRecorder::find(const traffic::TrafficSnapshot& snapshot,
                                             const Object& object) const {
  if (object.gone) return nullptr;
  const traffic::Vehicle* vehicle = snapshot.find(object.id);
  if (vehicle == nullptr) return nullptr;
  return sumo_drives_ || vehicle->role == traffic::VehicleRole::kCbv ? vehicle : nullptr;
}

double CourseRecorder::edgeDistance(const traffic::Vehicle& vehicle) const {
  return -setup_.drivableArea().signedDistance(vehicle.box(), vehicle.state.elevation);
}

void CourseRecorder::note(const traffic::TrafficSnapshot& snapshot, Object& object) const {
  const traffic::Vehicle* vehicle = find(snapshot, object);
  if (vehicle == nullptr) {
    object.gone = true;
    return;
  }
  if (collides(snapshot, *vehicle)) object.collided = 1.0;
  if (edgeDistance(*vehicle) > 0.0) object.off_road = 1.0;
  object.lines.observe(*vehicle, snapshot.signals);
  if (object.lines.redLights() > object.red_lights) object.red_light = 1.0;
  object.red_lights = object.lines.redLights();
}

void CourseRecorder::closeStep(double edge, Object& object) {
  // A vehicle that touched another between two steps has left, but what it did counts.
  const bool counts = !object.gone || object.collided + object.off_road + object.red_light > 0.0;
  object.course[kRoadEdge].push_back(edge);
  object.course[kCollision].push_back(counts ? object.collided : kNoValue);
  object.course[kOffRoad].push_back(counts ? object.off_road : kNoValue);
  object.course[kRedLight].push_back(counts ? object.red_light : kNoValue);
  object.collided = object.off_road = object.red_light = 0.0;
}

std::optional<Continuation> CourseRecorder::take() {
  if (!found_) return std::nullopt;
  const Recording recording = builder_.take();
  std::vector<Motion> motions;
  for (const Track& track : recording.tracks) motions.push_back(centralMotion(track));
  for (Object& object : objects_) {
    const auto track =
        std::find_if(recording.tracks.begin(), recording.tracks.end(),
                     [&](const Track& candidate) { return candidate.id == object.id; });
    const auto index = static_cast<std::size_t>(track - recording.tracks.begin());
    Course course = courseOf(recording, motions, index, first_step_, first_step_ + steps_);
    for (const Feature feature : {kRoadEdge, kCollision, kOffRoad, kRedLight}) {
      course[feature] = object.course[feature];
      course[feature].resize(steps_, kNoValue);
    }
    for (std::size_t step = 0; step < steps_; ++step) {
      if (!std::isnan(course[kRoadEdge][step])) continue;
      for (const Feature feature : {kLinearSpeed, kLinearAcceleration, kAngularSpeed,
                                    kAngularAcceleration, kNearestObject, kTimeToCollision})
        course[feature][step] = kNoValue;
    }
    found_->courses.push_back(std::move(course));
  }
  return std::move(found_);
}

}  // namespace cdiff::realism
