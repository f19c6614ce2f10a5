// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/logs/hold_up_log.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "session/scenario_review.h"

namespace cdiff::record {
namespace {

using traffic::SessionStatus;
using traffic::Vehicle;

constexpr double kAround = 50.0;      ///< of the ego: the traffic around it [m]
constexpr double kMovingSpeed = 0.1;  ///< of a vehicle that moves [m/s]
constexpr double kSample = 1.0;       ///< between two looks at what the ego waits for [s]
constexpr double kShort = 1.0;        ///< a shorter standstill explains nothing [s]
constexpr double kEndRounding = 1e-6;

/// "1.5 s".
std::string secondsText(double seconds) { return core::formatFixed(seconds, 1) + " s"; }

std::string atJunction(const std::string& junction) {
  return junction.empty() ? "" : " at junction " + junction;
}

/// What a vehicle other than the ego does, as the end of a sentence that starts with its id.
std::string waitText(const Wait& wait) {
  switch (wait.reason) {
    case Wait::For::kVehicle:
      if (wait.yields) return "yields" + atJunction(wait.junction) + " to " + wait.obstacle;
      return wait.junction.empty()
                 ? "stands behind " + wait.obstacle
                 : "stands" + atJunction(wait.junction) + ", blocked by " + wait.obstacle;
    case Wait::For::kLight:
      return "waits for light " + wait.obstacle + atJunction(wait.junction);
    case Wait::For::kStopLine:
      return "waits at the stop line" + atJunction(wait.junction);
    case Wait::For::kStop:
      return "is at a SUMO stop of the demand on lane " + wait.obstacle + ", " + wait.until;
    case Wait::For::kNoWay:
      return "stands at the end of lane " + wait.obstacle + ", from which no lane leads on";
    case Wait::For::kNothing:
      break;
  }
  return "stands" + atJunction(wait.junction) + ", its way free as far as traffic and lights show";
}

/// Where the ego stood, as the end of "The ego stood 3.0 s".
std::string placeText(const Wait& wait, const std::string& planner) {
  switch (wait.reason) {
    case Wait::For::kVehicle:
      if (wait.yields) return atJunction(wait.junction) + ", where it yields to " + wait.obstacle;
      return (wait.junction.empty() ? " behind " : atJunction(wait.junction) + ", blocked by ") +
             wait.obstacle;
    case Wait::For::kLight:
      return " for light " + wait.obstacle + atJunction(wait.junction);
    case Wait::For::kStopLine:
      return " at the stop line" + atJunction(wait.junction);
    case Wait::For::kStop:
    case Wait::For::kNoWay:
    case Wait::For::kNothing:
      break;
  }
  return atJunction(wait.junction) + " with nothing in its way: its own planner, " + planner +
         ", held it";
}

/// The vehicles from the head of the ego's queue on, and what each waits for: the first ones and
/// the last one.
std::string headText(const WaitChain& chain) {
  constexpr std::size_t kShown = 3;
  const std::size_t queue = chain.queue().size();
  const std::size_t first = std::max<std::size_t>(1, queue);
  std::string text;
  for (std::size_t i = first; i < chain.waits.size(); ++i) {
    const bool last = i + 1 == chain.waits.size();
    if (i >= first + kShown && !last) continue;
    const bool head = i == queue && queue > 1;
    text += i > first + kShown ? "; ... " : "; ";
    text += (head ? "head of the queue of " + std::to_string(queue) + ": " : "") +
            chain.waits[i].vehicle + " " + waitText(chain.waits[i]);
  }
  if (chain.ring) text += "; they wait for each other in a ring";
  return text;
}

/// Who is to blame at the end of the chain, where no CBV is in it.
std::string causeText(const WaitChain& chain) {
  const Wait& last = chain.waits.back();
  const std::string& cause =
      last.reason == Wait::For::kVehicle && !chain.ring ? last.obstacle : last.vehicle;
  return "no CBV waits in this queue, " + cause + " is background traffic";
}

std::optional<session::DemandFile> demandOf(const session::ScenarioOptions& options) {
  if (!session::hasDemandFile(options)) return std::nullopt;
  try {
    return session::DemandFile(options.demand);
  } catch (const core::InputError&) {
    return std::nullopt;  // a recording's; the session itself would not have started
  }
}

}  // namespace

HoldUpLog::HoldUpLog(const session::SessionSetup& setup)
    : setup_(setup), demand_(demandOf(setup.options())) {}

void HoldUpLog::observe(const traffic::TrafficSnapshot& snapshot) {
  for (const Vehicle& vehicle : snapshot.vehicles) {
    if (vehicle.role == traffic::VehicleRole::kCbv) cbvs_.insert(vehicle.id);
  }
  const Vehicle* ego = snapshot.ego();
  if (ego == nullptr) return;
  noteMotion(snapshot, *ego);
  noteStandstill(snapshot, ego->state.speed);
  const bool ends =
      snapshot.status == SessionStatus::kBlocked || snapshot.status == SessionStatus::kTimedOut;
  const double phase = std::fmod(snapshot.time + kEndRounding, kSample);
  if (!ends && phase >= setup_.options().simulation_step) return;
  const WaitChain chain = chainAt(snapshot);
  if (standing_since_) {
    const HoldUp now = standstill(snapshot, chain);
    if (!longest_ || now.seconds >= longest_->seconds) longest_ = now;
  }
  noteSlowness(*ego, standing_since_.has_value(), chain);
  if (ends) conclude(snapshot, chain);
}

void HoldUpLog::noteStandstill(const traffic::TrafficSnapshot& snapshot, double speed) {
  const double still = setup_.options().protocol.blocked_speed;
  if (speed >= std::max(still, kCreepSpeed)) standing_since_.reset();
  if (speed < still && !standing_since_) {
    standing_since_ = snapshot.time;
    crept_ = 0.0;
  }
  if (!standing_since_) return;
  stood_ += setup_.options().simulation_step;
  if (speed >= still) crept_ += setup_.options().simulation_step;
}

WaitChain HoldUpLog::chainAt(const traffic::TrafficSnapshot& snapshot) const {
  const session::ScenarioOptions& options = setup_.options();
  const KnownDemand demand{demand_ ? &*demand_ : nullptr,
                           options.begin_time + options.traffic.warm_up + snapshot.time};
  return waitChain(snapshot, setup_.network(), setup_.egoRoute(), demand);
}

void HoldUpLog::noteMotion(const traffic::TrafficSnapshot& snapshot, const Vehicle& ego) {
  company_ = false;
  bool moves = false;
  for (const Vehicle& other : snapshot.vehicles) {
    const bool near = (other.state.position - ego.state.position).norm() < kAround;
    if (other.id == ego.id || !near || traffic::onDifferentLevels(other, ego)) continue;
    company_ = true;
    moves = moves || other.state.speed >= kMovingSpeed;
  }
  if (moves) traffic_still_since_.reset();
  if (!moves && !traffic_still_since_) traffic_still_since_ = snapshot.time;
}

void HoldUpLog::noteSlowness(const Vehicle& ego, bool stands, const WaitChain& chain) {
  const map::Route& route = setup_.egoRoute();
  const double place = route.path().project(ego.state.position).arc_length;
  const double target = std::min(setup_.options().target_speed, route.speedLimitAt(place));
  if (ego.state.speed >= 0.5 * target) return;
  if (!stands) slow_ += kSample;
  const bool behind = !chain.waits.empty() && chain.waits[0].reason == Wait::For::kVehicle;
  if (behind) held_behind_[chain.waits[0].obstacle] += kSample;
}

HoldUp HoldUpLog::standstill(const traffic::TrafficSnapshot& snapshot,
                             const WaitChain& chain) const {
  HoldUp hold_up;
  hold_up.begin = *standing_since_;
  hold_up.seconds = snapshot.time - *standing_since_;
  hold_up.crept = crept_;
  hold_up.chain = chain;
  if (company_)
    hold_up.traffic_still = snapshot.time - traffic_still_since_.value_or(snapshot.time);
  std::set<std::string> members;
  for (const Wait& wait : chain.waits) members.insert({wait.vehicle, wait.obstacle});
  for (const std::string& id : members) {
    if (cbvs_.count(id) != 0) hold_up.cbvs.push_back(id);
  }
  return hold_up;
}

void HoldUpLog::conclude(const traffic::TrafficSnapshot& snapshot, const WaitChain& chain) {
  HoldUp result;
  if (standing_since_ && snapshot.status == SessionStatus::kBlocked)
    result = standstill(snapshot, chain);
  else if (longest_ && longest_->seconds >= kShort)
    result = *longest_;
  result.at_end =
      standing_since_ && !result.chain.waits.empty() && result.begin == *standing_since_;
  result.stood = stood_;
  result.slow = slow_;
  for (const auto& [id, seconds] : held_behind_) {
    if (seconds <= result.held_behind_seconds) continue;
    result.held_behind = id;
    result.held_behind_seconds = seconds;
  }
  result.held_behind_seconds = std::min(result.held_behind_seconds, stood_ + slow_);
  found_ = result;
}

namespace {

std::string standstillText(const HoldUp& hold_up, const session::SessionSetup& setup) {
  const WaitChain& chain = hold_up.chain;
  const std::string crept =
      hold_up.crept < kShort ? "" : " (creeping for " + secondsText(hold_up.crept) + " of it)";
  std::string text = "The ego stood " + secondsText(hold_up.seconds) + crept +
                     (hold_up.at_end ? "" : " from " + secondsText(hold_up.begin) + " on") +
                     placeText(chain.waits.front(), setup.options().ego_planner) + headText(chain);
  if (hold_up.traffic_still && *hold_up.traffic_still >= kShort)
    text += "; the traffic around had not moved for " + secondsText(*hold_up.traffic_still);
  if (chain.waits.front().reason == Wait::For::kVehicle) {
    text += hold_up.cbvs.empty() ? "; " + causeText(chain)
                                 : "; CBV with a part in it: " + core::joinText(hold_up.cbvs, ", ");
  }
  return text + ".";
}

/// Of a session that timed out.
std::string timeText(const HoldUp& hold_up, const session::SessionSetup& setup) {
  const map::Route& route = setup.egoRoute();
  std::string text = "It stood " + secondsText(hold_up.stood) + " in all";
  if (hold_up.slow >= kShort)
    text += " and drove slower than half its target speed for " + secondsText(hold_up.slow);
  if (!hold_up.held_behind.empty()) {
    text += "; for " + secondsText(hold_up.held_behind_seconds) + " of this " +
            hold_up.held_behind + " was before it";
  }
  const session::ScenarioOptions& options = setup.options();
  text += "; the time limit was " + core::formatNumber(options.protocol.time_limit) + " s" +
          (options.protocol.time_limit_speed_percent > 0.0 ? " and what its progress added" : "");
  return text + "; its route takes " + secondsText(session::drivingTime(options, route)) +
         " at target speed.";
}

}  // namespace

std::string holdUpText(const HoldUp& hold_up, const session::SessionSetup& setup,
                       SessionStatus status) {
  const bool stood = !hold_up.chain.waits.empty();
  std::string text = stood ? standstillText(hold_up, setup) : "";
  if (status != SessionStatus::kTimedOut) return text;
  if (!stood) text = "Nothing stopped the ego.";
  return text + " " + timeText(hold_up, setup);
}

}  // namespace cdiff::record
