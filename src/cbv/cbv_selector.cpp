// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "cbv/cbv_selector.h"

#include <algorithm>
#include <cmath>

#include "cbv/candidate_gates.h"
#include "cbv/cbv_options.h"
#include "cbv/conflict_search.h"
#include "e2e_cdiff/cbv/cbv_selection.h"
#include "e2e_cdiff/core/exceptions.h"
#include "traffic/vehicle_class.h"

namespace cdiff::cbv {
namespace {

constexpr int kNoSlot = -1;

const CbvOptions& validated(const CbvOptions& options) {
  options.validate();
  return options;
}

}  // namespace

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

CbvSelector::CbvSelector(const CbvOptions& options, int max_cbv, const map::LaneGraph& graph,
                         const map::Route& ego_route, const std::string& mode)
    : life_cycle_(options.life_cycle),
      options_(validated(options).inMode(mode)),
      max_cbv_(max_cbv),
      graph_(graph.allowingTurnsOf(ego_route)),
      ego_route_(ego_route),
      search_(options_, graph_, ego_route) {
  if (max_cbv < 0)
    throw core::InputError("max_cbv is " + std::to_string(max_cbv) + "; expected 0 or more");
}

void CbvSelector::observe(const traffic::TrafficSnapshot& snapshot) {
  for (const traffic::Contact& contact : snapshot.contacts) {
    contacted_.insert(contact.first);
    contacted_.insert(contact.second);
  }
}

CbvSelection CbvSelector::update(const traffic::TrafficSnapshot& snapshot) {
  CbvSelection selection;
  selection.tick = snapshot.tick;
  const traffic::Vehicle* ego = snapshot.ego();
  if (ego != nullptr) followEgo(*ego);
  followMode(snapshot);
  releaseSteered(snapshot, selection);
  updateHeld(snapshot, selection);
  if (ego != nullptr) chooseSteered(snapshot, selection);
  if (ego != nullptr && max_cbv_ > 0 && selectionDue(snapshot.time)) select(snapshot, selection);
  for (const auto& [slot, held] : slots_) selection.assignments.push_back(held.assignment());
  std::sort(selection.released.begin(), selection.released.end(),
            [](const auto& left, const auto& right) { return left.slot < right.slot; });
  std::sort(selection.rejected.begin(), selection.rejected.end(),
            [](const auto& left, const auto& right) { return left.vehicle_id < right.vehicle_id; });
  return selection;
}

/// Who is held stays; who was released for good under "rift" stays released.
void CbvSelector::followMode(const traffic::TrafficSnapshot& snapshot) {
  for (const traffic::SteeringChange& change : snapshot.steering) {
    if (change.what != traffic::steered::kMode) continue;
    options_.life_cycle = life_cycle_;
    options_ = options_.inMode(change.after);
  }
}

void CbvSelector::followEgo(const traffic::Vehicle& ego) {
  constexpr double kOffRouteAtFirst = 5.0;  // [m] it may start anywhere on its route
  const geometry::Polyline& path = ego_route_.path();
  ego_.state = ego.state;
  ego_.arc_length = seen_ego_ ? advancedArcLength(path, ego_.arc_length, ego.state.position)
                              : advancedArcLength(path, 0.0, ego.state.position, kOffRouteAtFirst);
  seen_ego_ = true;
}

/// Selections fall on the first decision at or after first_time + n period; the tolerance absorbs
/// rounded times.
bool CbvSelector::selectionDue(double time) {
  constexpr double kTolerance = 1e-6;
  const double index = std::floor((time - options_.first_time) / options_.period + kTolerance);
  if (index < 0.0 || index <= last_selection_) return false;
  last_selection_ = index;
  return true;
}

bool CbvSelector::holds(const std::string& vehicle_id) const {
  return std::any_of(slots_.begin(), slots_.end(),
                     [&](const auto& slot) { return slot.second.vehicleId() == vehicle_id; });
}

void CbvSelector::updateHeld(const traffic::TrafficSnapshot& snapshot, CbvSelection& selection) {
  for (int slot = 0; slot < max_cbv_; ++slot) {
    const auto held = slots_.find(slot);
    if (held == slots_.end()) continue;
    const traffic::Vehicle* vehicle = snapshot.find(held->second.vehicleId());
    if (vehicle != nullptr) held->second.update(*vehicle, ego_, options_.minimum_speed);
    const bool contact = contacted_.count(held->second.vehicleId()) != 0;
    const char* reason = contact ? kContact : held->second.releaseReason(snapshot);
    if (reason != nullptr) release(slot, reason, selection);
  }
  contacted_.clear();
}

void CbvSelector::release(int slot, const char* reason, CbvSelection& selection) {
  const auto held = slots_.find(slot);
  selection.released.push_back({slot, held->second.vehicleId(), reason});
  if (!reselects()) never_again_.insert(held->second.vehicleId());
  slots_.erase(held);
}

void CbvSelector::releaseSteered(const traffic::TrafficSnapshot& snapshot,
                                 CbvSelection& selection) {
  for (const traffic::SteeringChange& change : snapshot.steering) {
    if (change.what != traffic::steered::kRelease && change.what != traffic::steered::kRemove)
      continue;
    const auto held = std::find_if(slots_.begin(), slots_.end(), [&](const auto& slot) {
      return slot.second.vehicleId() == change.before;
    });
    if (held == slots_.end()) continue;
    release(held->first, kSteered, selection);
    never_again_.insert(change.before);  // in any life cycle, until it is chosen by hand
  }
}

void CbvSelector::chooseSteered(const traffic::TrafficSnapshot& snapshot, CbvSelection& selection) {
  refused_.clear();
  for (const traffic::SteeringChange& change : snapshot.steering) {
    if (change.what == traffic::steered::kChoose) choose(snapshot, change.after, selection);
  }
}

/// Takes the vehicle, whatever its rank and whether it was a CBV before, in a free slot or that of
/// the weakest CBV.
void CbvSelector::choose(const traffic::TrafficSnapshot& snapshot, const std::string& vehicle_id,
                         CbvSelection& selection) {
  if (holds(vehicle_id)) return;
  const bool was_cbv = never_again_.erase(vehicle_id) > 0;
  Candidate candidate;
  candidate.vehicle = snapshot.find(vehicle_id);
  const char* reason = candidate.vehicle == nullptr ? kGone : examine(snapshot, candidate);
  const int free = slotFor(candidate, snapshot.tick);
  const int slot = free == kNoSlot ? weakestSlot(snapshot.tick) : free;
  std::optional<HeldCbv> chosen;
  if (reason == nullptr) reason = whyNot(snapshot, candidate, chosen, slot);
  if (reason != nullptr) {
    if (was_cbv) never_again_.insert(vehicle_id);
    if (refused_.insert(vehicle_id).second)
      selection.rejected.push_back({vehicle_id, reason, candidate.conflict.score});
    return;
  }
  if (slots_.count(slot) != 0) release(slot, kSteered, selection);
  slots_.emplace(slot, std::move(*chosen));
}

/// Why the candidate cannot have the slot; nullptr with `chosen` set where it can.
const char* CbvSelector::whyNot(const traffic::TrafficSnapshot& snapshot,
                                const Candidate& candidate, std::optional<HeldCbv>& chosen,
                                int slot) const {
  if (slot == kNoSlot) return kOutranked;
  chosen = makeHeld(slot, candidate, snapshot.tick);
  if (!chosen) return kNoWay;
  return hasContactAhead(snapshot, candidate, *chosen) ? kContactAhead : nullptr;
}

bool CbvSelector::mayBeTaken(const std::string& vehicle_id) const {
  const std::vector<std::string>& only = options_.only;
  return only.empty() || std::find(only.begin(), only.end(), vehicle_id) != only.end();
}

void CbvSelector::releaseLost(const traffic::TrafficSnapshot& snapshot, CbvSelection& selection) {
  constexpr double kTolerance = 1e-6;
  for (int slot = 0; slot < max_cbv_; ++slot) {
    const auto found = slots_.find(slot);
    if (found == slots_.end()) continue;
    HeldCbv& held = found->second;
    const traffic::Vehicle& vehicle = *snapshot.find(held.vehicleId());
    const LanePlacement placement = placeOnLane(graph_.network(), vehicle, options_);
    std::optional<double> score;
    if (placement.reason == nullptr) {
      const ConflictResult result = search_.find(vehicle.state, placement.place, ego_);
      if (result.conflict) score = result.conflict->score;
    }
    held.setPresentScore(score, snapshot.time);
    const bool lost =
        !score && held.lostTime(snapshot.time) >= options_.lost_conflict_time - kTolerance;
    if (lost) release(slot, kConflictLost, selection);
  }
}

void CbvSelector::select(const traffic::TrafficSnapshot& snapshot, CbvSelection& selection) {
  if (reselects()) releaseLost(snapshot, selection);
  for (const Candidate& candidate : rankedCandidates(snapshot, selection)) {
    const std::string& id = candidate.vehicle->id;
    const int slot = slotFor(candidate, snapshot.tick);
    std::optional<HeldCbv> chosen;
    if (const char* reason = whyNot(snapshot, candidate, chosen, slot)) {
      selection.rejected.push_back({id, reason, candidate.conflict.score});
      continue;
    }
    if (slots_.count(slot) != 0) release(slot, kOutranked, selection);
    slots_.emplace(slot, std::move(*chosen));
  }
}

std::vector<CbvSelector::Candidate> CbvSelector::rankedCandidates(
    const traffic::TrafficSnapshot& snapshot, CbvSelection& selection) const {
  std::vector<Candidate> candidates;
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
    if (vehicle.role != traffic::VehicleRole::kBackground || holds(vehicle.id)) continue;
    if (refused_.count(vehicle.id) != 0) continue;
    Candidate candidate;
    candidate.vehicle = &vehicle;
    const char* reason = mayBeTaken(vehicle.id) ? examine(snapshot, candidate) : kNotNamed;
    if (reason == nullptr) {
      candidates.push_back(candidate);
    } else {
      selection.rejected.push_back({vehicle.id, reason, 0.0});
    }
  }
  std::sort(
      candidates.begin(), candidates.end(), [&](const Candidate& left, const Candidate& right) {
        const double left_key = rankingKey(left);
        const double right_key = rankingKey(right);
        return left_key != right_key ? left_key < right_key : left.vehicle->id < right.vehicle->id;
      });
  return candidates;
}

/// Candidates with a smaller key come first, those with equal keys by id.
double CbvSelector::rankingKey(const Candidate& candidate) const {
  if (options_.ranking == "nearest") return candidate.separation;
  if (options_.ranking == "gates") return 0.0;
  return -candidate.conflict.score;
}

/// The first gate that the candidate's vehicle fails, or nullptr with the other fields filled.
const char* CbvSelector::examine(const traffic::TrafficSnapshot& snapshot,
                                 Candidate& candidate) const {
  const traffic::Vehicle& vehicle = *candidate.vehicle;
  if (traffic::isSmall(vehicle.dimensions)) return kTooSmall;
  if (never_again_.count(vehicle.id) != 0) return kAlreadyChosen;
  if (inContact(snapshot, vehicle.id)) return kInContact;
  const char* failed = failedNearness(vehicle, *snapshot.ego(), options_);
  if (failed != nullptr) return failed;
  const LanePlacement placement = placeOnLane(graph_.network(), vehicle, options_);
  if (placement.reason != nullptr) return placement.reason;
  if (queued(vehicle, placement.place)) return kQueued;
  const ConflictResult result = search_.find(vehicle.state, placement.place, ego_);
  if (!result.conflict) return result.reason;
  candidate.place = placement.place;
  candidate.conflict = *result.conflict;
  candidate.separation = (vehicle.state.position - ego_.state.position).norm();
  return nullptr;
}

bool CbvSelector::queued(const traffic::Vehicle& vehicle, const map::LanePosition& place) const {
  if (vehicle.state.speed >= options_.queue_speed) return false;
  const std::vector<map::LaneIndex>& lanes = ego_route_.lanes();
  return std::find(lanes.begin(), lanes.end(), place.lane) != lanes.end();
}

/// The candidate goes along its conflict-aware route, as do the CBVs; the ego follows its route.
bool CbvSelector::hasContactAhead(const traffic::TrafficSnapshot& snapshot,
                                  const Candidate& candidate, const HeldCbv& chosen) const {
  std::vector<Motion> others;
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
    if (vehicle.id == candidate.vehicle->id) continue;
    const auto held = std::find_if(slots_.begin(), slots_.end(), [&](const auto& slot) {
      return slot.second.vehicleId() == vehicle.id;
    });
    if (held != slots_.end()) {
      others.push_back(held->second.motion(vehicle));
    } else if (vehicle.role == traffic::VehicleRole::kEgo) {
      others.push_back({vehicle, &ego_route_.path(), ego_.arc_length});
    } else {
      others.push_back({vehicle});
    }
  }
  return contactAhead(chosen.motion(*candidate.vehicle), others, options_.clear_time);
}

/// The lowest free slot; in the life cycle "reselect" else that of the weakest CBV when the
/// candidate is better enough.
int CbvSelector::slotFor(const Candidate& candidate, std::uint64_t tick) const {
  for (int slot = 0; slot < max_cbv_; ++slot) {
    if (slots_.count(slot) == 0) return slot;
  }
  if (!reselects()) return kNoSlot;
  const int weakest = weakestSlot(tick);
  if (weakest == kNoSlot) return kNoSlot;
  const double needed = slots_.at(weakest).presentScore() + options_.hysteresis;
  return candidate.conflict.score > needed ? weakest : kNoSlot;
}

/// That of the CBV with the lowest present score that was not selected at this tick.
int CbvSelector::weakestSlot(std::uint64_t tick) const {
  int weakest = kNoSlot;
  for (const auto& [slot, held] : slots_) {
    if (held.assignment().selected_tick == tick) continue;
    if (weakest == kNoSlot || held.presentScore() < slots_.at(weakest).presentScore())
      weakest = slot;
  }
  return weakest;
}

/// The candidate with its conflict-aware route; nullopt when the graph finds no route to the
/// conflict point.
std::optional<HeldCbv> CbvSelector::makeHeld(int slot, const Candidate& candidate,
                                             std::uint64_t tick) const {
  const Conflict& conflict = candidate.conflict;
  const double longest = conflict.point.cbv_distance + options_.route_distance_gate;
  const auto path = graph_.shortestPath(candidate.place, conflict.place, longest);
  if (!path) return std::nullopt;
  const map::Route to_conflict =
      graph_.toRoute(*path, candidate.place.arc_length, conflict.place.arc_length);
  CbvAssignment assignment;
  assignment.slot = slot;
  assignment.vehicle_id = candidate.vehicle->id;
  assignment.interaction_score = conflict.score;
  assignment.selected_tick = tick;
  assignment.conflict_point = conflict.point;
  assignment.conflict_aware_route = graph_.extended(to_conflict, options_.route_length);
  return HeldCbv(std::move(assignment), to_conflict.length());
}

const CbvAssignment* CbvSelection::find(int slot) const {
  const auto found = std::find_if(assignments.begin(), assignments.end(),
                                  [&](const auto& assignment) { return assignment.slot == slot; });
  return found == assignments.end() ? nullptr : &*found;
}

}  // namespace cdiff::cbv
