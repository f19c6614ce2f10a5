// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/logs/driving_log.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "e2e_cdiff/planning/perception.h"
#include "metrics/formulas/ttc_2d.h"

namespace cdiff::record {

Histogram::Histogram(double low, double width, std::size_t bins)
    : low_(low), width_(width), counts_(bins, 0) {}

void Histogram::add(double value) {
  if (!std::isfinite(value)) return;
  const double last = static_cast<double>(counts_.size() - 1);
  const double bin = std::clamp(std::floor((value - low_) / width_), 0.0, last);
  ++counts_[static_cast<std::size_t>(bin)];
  statistics_.add(value);
}

double Histogram::share(std::size_t bin) const {
  return n() == 0 ? 0.0 : static_cast<double>(counts_[bin]) / static_cast<double>(n());
}

void DrivingLog::observe(const traffic::TrafficSnapshot& snapshot) {
  if (!snapshot.decision_tick) return;
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
    if (vehicle.role == traffic::VehicleRole::kEgo) continue;
    Role& role = vehicle.role == traffic::VehicleRole::kCbv ? cbv_ : background_;
    role.speed.add(vehicle.state.speed);
    role.acceleration.add(vehicle.acceleration);
  }
}

namespace {

constexpr double kFramePeriod = 0.2;  // [s]

/// Gap between the boxes of the ego and a CBV on its level [m]; nullopt without ego or on another
/// level.
std::optional<double> gapToEgo(const traffic::Vehicle* ego, const traffic::Vehicle& vehicle) {
  if (ego == nullptr || traffic::onDifferentLevels(*ego, vehicle)) return std::nullopt;
  return geometry::distance(ego->box(), vehicle.box());
}

metrics::MovingBox movingBox(const traffic::Vehicle& vehicle) {
  return {vehicle.box(), vehicle.state.velocity()};
}

/// 2D-TTC [s] as the metrics define it: of the ego with anyone, of a CBV with the ego.
std::optional<double> timeToCollision(const traffic::TrafficSnapshot& snapshot,
                                      const traffic::Vehicle* ego,
                                      const traffic::Vehicle& vehicle) {
  if (ego == nullptr) return std::nullopt;
  if (&vehicle == ego) return metrics::interactionOf(*ego, snapshot, {}).ttc_2d;
  if (traffic::onDifferentLevels(*ego, vehicle)) return std::nullopt;
  return metrics::timeToCollision2d(movingBox(*ego), movingBox(vehicle));
}

TimelinePose poseOf(const traffic::Vehicle& vehicle) {
  TimelinePose pose;
  pose.x = vehicle.state.position.x();
  pose.y = vehicle.state.position.y();
  pose.heading = static_cast<float>(vehicle.state.heading);
  pose.speed = static_cast<float>(vehicle.state.speed);
  pose.role = vehicle.role;
  if (vehicle.applied_action) {
    pose.driven = true;
    pose.throttle = static_cast<float>(vehicle.applied_action->throttle);
    pose.steer = static_cast<float>(vehicle.applied_action->steer);
    pose.brake = static_cast<float>(vehicle.applied_action->brake);
  }
  return pose;
}

/// What a pose of ego or CBV says beyond that of a background vehicle.
void addEncounter(TimelinePose& pose, const traffic::TrafficSnapshot& snapshot,
                  const traffic::Vehicle* ego, const traffic::Vehicle& vehicle) {
  pose.time_to_collision =
      static_cast<float>(timeToCollision(snapshot, ego, vehicle).value_or(-1.0));
  if (vehicle.role != traffic::VehicleRole::kCbv) return;
  pose.slot = vehicle.cbv_slot;
  pose.gap = static_cast<float>(gapToEgo(ego, vehicle).value_or(-1.0));
}

}  // namespace

LoneFrame loneFrame(const traffic::TrafficSnapshot& snapshot) {
  LoneFrame lone;
  lone.frame.time = snapshot.time;
  lone.frame.poses.reserve(snapshot.vehicles.size());
  lone.vehicles.reserve(snapshot.vehicles.size());
  const traffic::Vehicle* ego = snapshot.ego();
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
    TimelinePose& pose = lone.frame.poses.emplace_back(poseOf(vehicle));
    pose.vehicle = static_cast<std::uint32_t>(lone.vehicles.size());
    lone.vehicles.push_back({vehicle.id, vehicle.dimensions.length, vehicle.dimensions.width});
    const bool background = vehicle.role == traffic::VehicleRole::kBackground;
    if (!background) addEncounter(pose, snapshot, ego, vehicle);
  }
  return lone;
}

Timeline::Timeline(double simulation_step, std::pmr::memory_resource* memory)
    : ticks_per_frame_(
          static_cast<std::uint64_t>(std::max(1.0, std::round(kFramePeriod / simulation_step)))),
      vehicles_(memory),
      index_by_id_(memory),
      frames_(memory) {}

void Timeline::observe(const traffic::TrafficSnapshot& snapshot) {
  duration_ = snapshot.time;
  const bool last = snapshot.status != traffic::SessionStatus::kRunning;
  const bool contact = !snapshot.contacts.empty();
  if (last || contact || snapshot.tick % ticks_per_frame_ == 0) {
    frames_.push_back(kept(frameOf(snapshot)));
    frames_.back().event = contact;
  }
  addContacts(snapshot);
  updateGap(snapshot);
}

void Timeline::addEvent(const LoneFrame& event) {
  const double event_time = event.frame.time;
  const auto next =
      std::lower_bound(frames_.begin(), frames_.end(), event_time,
                       [](const TimelineFrame& frame, double time) { return frame.time < time; });
  if (next != frames_.end() && next->time == event_time) {
    next->event = true;
    return;
  }
  TimelineFrame frame = adopt(event);
  frame.event = true;
  if (next != frames_.begin()) {
    frame.gazes = std::prev(next)->gazes;
    frame.perception = std::prev(next)->perception;
  }
  frames_.insert(next, kept(frame));
}

TimelineFrame Timeline::frameOf(const traffic::TrafficSnapshot& snapshot) {
  return adopt(loneFrame(snapshot));
}

/// The frame in the timeline's memory.
TimelineFrame Timeline::kept(const TimelineFrame& frame) {
  std::pmr::memory_resource* memory = frames_.get_allocator().resource();
  return {frame.time, {frame.poses, memory}, {frame.gazes, memory}, frame.perception, frame.event};
}

/// The frame with its poses counted in the timeline's vehicles.
TimelineFrame Timeline::adopt(LoneFrame lone) {
  for (TimelinePose& pose : lone.frame.poses) pose.vehicle = indexOf(lone.vehicles[pose.vehicle]);
  return std::move(lone.frame);
}

void Timeline::observeAttention(const traffic::TrafficSnapshot& snapshot,
                                const std::vector<planning::PlannedAction>& actions) {
  constexpr std::size_t kMost = 8;
  constexpr double kLeast = 0.02;
  if (frames_.empty() || frames_.back().time != snapshot.time) return;
  for (const planning::PlannedAction& action : actions) {
    const auto driver = index_by_id_.find(action.vehicle_id);
    if (driver == index_by_id_.end()) continue;
    std::vector<planning::AttendedVehicle> attended = action.attended;
    std::stable_sort(attended.begin(), attended.end(), [](const auto& left, const auto& right) {
      return left.weight > right.weight;
    });
    attended.resize(std::min(attended.size(), kMost));
    for (const planning::AttendedVehicle& one : attended) {
      const auto vehicle = index_by_id_.find(one.vehicle_id);
      if (vehicle == index_by_id_.end() || !(one.weight >= kLeast)) continue;
      frames_.back().gazes.push_back(
          {driver->second, vehicle->second, static_cast<float>(std::min(one.weight, 1.0))});
    }
  }
}

void Timeline::observePerception(const traffic::TrafficSnapshot& snapshot,
                                 const std::vector<planning::PlannedAction>& actions) {
  if (frames_.empty() || frames_.back().time != snapshot.time) return;
  for (const planning::PlannedAction& action : actions) {
    if (action.slot != traffic::kEgoSlot) continue;
    planning::Perception seen = action.perception;
    for (planning::PerceivedVehicle& vehicle : seen.vehicles) {
      if (!vehicle.forecasts.empty()) vehicle.forecasts = {planning::likeliest(vehicle.forecasts)};
    }
    frames_.back().perception = std::move(seen);
  }
}

void Timeline::addContacts(const traffic::TrafficSnapshot& snapshot) {
  for (const traffic::Contact& contact : snapshot.contacts) {
    const traffic::Vehicle* first = snapshot.find(contact.first);
    const traffic::Vehicle* second = snapshot.find(contact.second);
    TimelineContact entry{snapshot.time, contact.first, contact.second, std::nullopt};
    if (first != nullptr && second != nullptr) {
      entry.position = 0.5 * (first->state.position + second->state.position);
    }
    contacts_.push_back(entry);
  }
}

std::optional<std::string> Timeline::lastContactOf(const std::string& id, double begin,
                                                   double end) const {
  constexpr double kRounding = 1e-6;  // [s]
  for (auto contact = contacts_.rbegin(); contact != contacts_.rend(); ++contact) {
    if (contact->time < begin - kRounding || contact->time > end + kRounding) continue;
    if (contact->first == id) return contact->second;
    if (contact->second == id) return contact->first;
  }
  return std::nullopt;
}

void Timeline::updateGap(const traffic::TrafficSnapshot& snapshot) {
  const traffic::Vehicle* ego = snapshot.ego();
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
    if (vehicle.role == traffic::VehicleRole::kBackground) break;  // ego first, then CBVs
    if (vehicle.role != traffic::VehicleRole::kCbv) continue;
    const std::optional<double> gap = gapToEgo(ego, vehicle);
    if (!gap || (smallest_gap_ && smallest_gap_->distance <= *gap)) continue;
    smallest_gap_ = SmallestGap{snapshot.time, *gap, vehicle.id};
  }
}

std::uint32_t Timeline::indexOf(const TimelineVehicle& vehicle) {
  const auto index = static_cast<std::uint32_t>(vehicles_.size());
  const auto [entry, added] = index_by_id_.emplace(vehicle.id, index);
  if (added) vehicles_.push_back(vehicle);
  return entry->second;
}

}  // namespace cdiff::record
