// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "session/session_control.h"

#include <algorithm>

#include "core/spelling.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::session {
namespace {

using core::InputError;
using traffic::VehicleRole;

constexpr double kFastestPace = 100.0;                 // times real time
constexpr double kTimeTolerance = 1e-6;                // [s]
constexpr std::size_t kMostRequests = 1000;            // between two decisions
constexpr std::uint64_t kMostSteps = 1000000;          // of one request
constexpr auto kLook = std::chrono::milliseconds(20);  // between looks at a paused session

std::vector<std::string> idsOf(const VehicleRoles& vehicles) {
  std::vector<std::string> ids;
  for (const auto& [id, role] : vehicles) ids.push_back(id);
  return ids;
}

}  // namespace

SessionControl::SessionControl(const SessionSetup& setup)
    : setup_(setup), at_most_(setup.options().at_most), cbvs_(setup.options()) {
  const std::vector<SteeringEntry>& entries = setup.options().steering;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    for (const SteeringRequest& request : requestsOf(entries[i])) {
      scheduled_.push_back({entries[i].at, request});
      if (request.what != steered::kPlace) continue;
      try {
        requireLane(placedVehicle(request.value));
      } catch (const InputError& error) {
        throw InputError("key 'steering[" + std::to_string(i) + "]': " + error.what());
      }
    }
  }
  std::stable_sort(
      scheduled_.begin(), scheduled_.end(),
      [](const Scheduled& left, const Scheduled& right) { return left.at < right.at; });
}

SessionControl::State SessionControl::state() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return state_;
}

/// Where the wall clock rules, nothing can be held back.
void SessionControl::requirePace(const std::string& what) const {
  if (state_ == State::kOver) throw InputError(what + ": the session is over");
  const double factor = setup_.options().real_time_factor;
  if (factor <= 0.0) return;
  throw InputError(what + ": the session follows the wall clock (real_time_factor " +
                   core::formatNumber(factor) + "); expected a session in lockstep");
}

void SessionControl::pause() {
  const std::lock_guard<std::mutex> lock(mutex_);
  requirePace("pause");
  if (state_ == State::kPaused) throw InputError("pause: the session is paused already");
  state_ = State::kPaused;
  steps_ = 0;
  changed_.notify_all();
}

void SessionControl::resume() {
  const std::lock_guard<std::mutex> lock(mutex_);
  requirePace("resume");
  if (state_ == State::kPlaying) throw InputError("resume: the session is not paused");
  state_ = State::kPlaying;
  steps_ = 0;
  pace_begins_ = true;
  changed_.notify_all();
}

void SessionControl::step(std::uint64_t ticks) {
  const std::lock_guard<std::mutex> lock(mutex_);
  requirePace("step");
  if (state_ == State::kStepping) {
    throw InputError("step: " + std::to_string(steps_) + " ticks of another step are left");
  }
  if (state_ != State::kPaused) throw InputError("step: the session runs; pause it before");
  if (ticks < 1 || ticks > kMostSteps) {
    throw InputError("step: " + std::to_string(ticks) + " ticks; expected 1 to " +
                     std::to_string(kMostSteps));
  }
  state_ = State::kStepping;
  steps_ = ticks;
}

bool SessionControl::awaitSteps(double seconds) {
  std::unique_lock<std::mutex> lock(mutex_);
  return changed_.wait_for(lock, std::chrono::duration<double>(seconds),
                           [this] { return state_ != State::kStepping; });
}

void SessionControl::setPace(double at_most) {
  const std::lock_guard<std::mutex> lock(mutex_);
  requirePace("pace");
  if (!(at_most >= 0.0 && at_most <= kFastestPace)) {
    throw InputError("pace: " + core::formatNumber(at_most) +
                     " times real time; expected a number in [0, " +
                     core::formatNumber(kFastestPace) + "], 0 for as fast as possible");
  }
  at_most_ = at_most;
  pace_begins_ = true;
}

double SessionControl::pace() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return at_most_;
}

void SessionControl::ask(const SteeringRequest& request) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (state_ == State::kOver) throw InputError(request.what + ": the session is over");
  if (asked_.size() >= kMostRequests) {
    throw InputError(request.what + ": " + std::to_string(kMostRequests) +
                     " requests wait for the next decision; ask again after it");
  }
  changeBy(request, vehicles_);
  const auto same = [&](const SteeringRequest& other) {
    return SteeredCbvs::concerns(request.what) && other.what == request.what;
  };
  asked_.erase(std::remove_if(asked_.begin(), asked_.end(), same), asked_.end());
  asked_.push_back(request);
}

std::string SessionControl::value(const std::string& what) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const SteeringRequest& request : asked_) {
    if (request.what == what) return request.value;
  }
  return cbvs_.value(what);
}

void SessionControl::quit() {
  const std::lock_guard<std::mutex> lock(mutex_);
  quitting_ = true;
}

bool SessionControl::quitting() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return quitting_;
}

SessionControl::Clock::duration SessionControl::holdBack(double simulated, Clock::time_point now) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (state_ == State::kStepping) {
    if (steps_ > 0) {
      --steps_;
      return Clock::duration::zero();
    }
    state_ = State::kPaused;
    changed_.notify_all();
  }
  if (state_ == State::kPaused) return kLook;
  if (pace_begins_) {
    pace_begins_ = false;
    paced_from_ = simulated;
    paced_since_ = now;
  }
  if (at_most_ <= 0.0) return Clock::duration::zero();
  const std::chrono::duration<double> due((simulated - paced_from_) / at_most_);
  const Clock::time_point wake = paced_since_ + std::chrono::duration_cast<Clock::duration>(due);
  return std::max(Clock::duration::zero(), std::min<Clock::duration>(wake - now, kLook));
}

std::vector<traffic::SteeringChange> SessionControl::take(double simulated,
                                                          const VehicleRoles& vehicles,
                                                          std::vector<std::string>& refused) {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<SteeringRequest> due;
  auto next = scheduled_.begin();
  for (; next != scheduled_.end() && next->at <= simulated + kTimeTolerance; ++next)
    due.push_back(next->request);
  scheduled_.erase(scheduled_.begin(), next);
  due.insert(due.end(), asked_.begin(), asked_.end());
  asked_.clear();
  std::vector<traffic::SteeringChange> changes;
  VehicleRoles present = vehicles;
  for (const SteeringRequest& request : due) {
    try {
      changes.push_back(changeBy(request, present));
      cbvs_.follow(changes.back());
      if (request.what == steered::kRemove) present.erase(request.value);
      if (request.what == steered::kPlace)
        present.emplace(placedVehicle(request.value).id, VehicleRole::kBackground);
    } catch (const InputError& error) {
      refused.push_back("what the " + request.by + " asks for cannot be: " + error.what() +
                        "; nothing was changed");
    }
  }
  return changes;
}

void SessionControl::note(VehicleRoles vehicles) {
  const std::lock_guard<std::mutex> lock(mutex_);
  vehicles_ = std::move(vehicles);
}

void SessionControl::end() {
  const std::lock_guard<std::mutex> lock(mutex_);
  state_ = State::kOver;
  steps_ = 0;
  changed_.notify_all();
}

traffic::SteeringChange SessionControl::changeBy(const SteeringRequest& request,
                                                 const VehicleRoles& vehicles) const {
  const auto& [by, what, value] = request;
  if (SteeredCbvs::concerns(what)) return cbvs_.changeBy(request);
  if (what == steered::kPlace) {
    requirePlace(placedVehicle(value), vehicles);
    return {by, what, "", toText(placedVehicle(value))};
  }
  const std::vector<std::string> known = {
      steered::kProfile, steered::kMode,    steered::kTargetSpeed, std::string(steered::kWeight),
      steered::kChoose,  steered::kRelease, steered::kPlace,       steered::kRemove};
  if (std::find(known.begin(), known.end(), what) == known.end()) {
    throw InputError("'" + core::shortened(what) + "' cannot be steered; expected one of " +
                     core::joinText(known, ", ") + " (weight. with the name of an objective)");
  }
  requireVehicle(request, vehicles);
  if (what == steered::kChoose) return {by, what, "", value};
  return {by, what, value, ""};
}

void SessionControl::requireVehicle(const SteeringRequest& request,
                                    const VehicleRoles& vehicles) const {
  const std::string place = request.what + ": vehicle '" + core::shortened(request.value) + "'";
  const auto found = vehicles.find(request.value);
  if (found == vehicles.end())
    throw InputError(place + " is not there" + core::didYouMean(request.value, idsOf(vehicles)));
  const VehicleRole role = found->second;
  if (role == VehicleRole::kEgo) throw InputError(place + " is the ego; expected another one");
  if (request.what == steered::kChoose && setup_.options().max_cbv == 0)
    throw InputError(place + " finds no slot: max_cbv is 0");
  if (request.what == steered::kChoose && role == VehicleRole::kCbv)
    throw InputError(place + " is a CBV already");
  if (request.what == steered::kRelease && role != VehicleRole::kCbv)
    throw InputError(place + " is no CBV");
}

void SessionControl::requirePlace(const PlacedVehicle& vehicle,
                                  const VehicleRoles& vehicles) const {
  const std::string place = "place: vehicle '" + core::shortened(vehicle.id) + "'";
  if (vehicles.count(vehicle.id) != 0) throw InputError(place + " is there already");
  const bool taken =
      vehicle.id == traffic::kEgoId || vehicle.id.rfind(simulation::kGeneratedPrefix, 0) == 0;
  if (taken || core::fileName(vehicle.id) != vehicle.id) {
    throw InputError(place + "; expected an id of letters, digits, '_', '-' and '.' other than '" +
                     std::string(traffic::kEgoId) + "', and not beginning with '" +
                     simulation::kGeneratedPrefix + "'");
  }
  requireLane(vehicle);
}

void SessionControl::requireLane(const PlacedVehicle& vehicle) const {
  const map::RoadNetwork& network = setup_.network();
  const map::LaneIndex lane = network.findLane(vehicle.lane);
  const std::string place = "place: vehicle '" + core::shortened(vehicle.id) + "': ";
  if (lane == map::kNoLane || network.lane(lane).internal || !network.lane(lane).routable) {
    throw InputError(place + "lane '" + core::shortened(vehicle.lane) +
                     "' is none of the network outside junctions that cars may use");
  }
  const double half = 0.5 * traffic::VehicleDimensions().length;
  const double length = network.lane(lane).centerline.length();
  if (!(vehicle.position >= half && vehicle.position <= length - half)) {
    throw InputError(place + "position " + core::formatNumber(vehicle.position) +
                     " m; expected a number in [" + core::formatNumber(half) + ", " +
                     core::formatNumber(length - half) + "] for the whole box to be on the lane");
  }
  const double fastest = network.lane(lane).speed_limit;
  if (!(vehicle.speed >= 0.0 && vehicle.speed <= fastest)) {
    throw InputError(place + "speed " + core::formatNumber(vehicle.speed) +
                     " m/s; expected a number in [0, " + core::formatNumber(fastest) +
                     "], the lane's limit");
  }
}

}  // namespace cdiff::session
