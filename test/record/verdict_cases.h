// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// One set of sessions with every outcome, that all readers of a verdict are tested on: the ego of
/// the sample session, whom another vehicle may strike or be struck by at 5 s.
#pragma once

#include <string>
#include <vector>

#include "record/sample_session.h"

namespace cdiff::test {

enum class Touch { kNone, kEgoAtFault, kUnavoidable, kEgoStruck };

struct VerdictCase {
  std::string name;
  std::string mode = "naturalistic";
  traffic::SessionStatus status = traffic::SessionStatus::kCompleted;
  std::uint64_t last_tick = 440;  ///< 22 s: 176 m of 190 m, 92.6 %
  Touch touch = Touch::kNone;
  bool rules = true;  ///< the standard ones
  bool judge = true;
  record::Outcome outcome = record::Outcome::kPassed;
  int exit_code = 0;
  std::string reason;  ///< part of one
};

inline const std::vector<VerdictCase>& verdictCases() {
  using record::Outcome;
  using traffic::SessionStatus;
  // 39 %: 74.1 m at 8 m/s are 9.26 s, tick 185.
  constexpr std::uint64_t kEarly = 185;
  const std::string kAttack = "safety_critical";
  const std::string kFree = "naturalistic";
  static const std::vector<VerdictCase> cases = {
      {"completed", kFree, SessionStatus::kCompleted, 440, Touch::kNone, true, true,
       Outcome::kPassed, 0, ""},
      {"timed_out_late", kFree, SessionStatus::kTimedOut, 440, Touch::kNone, true, true,
       Outcome::kPassed, 0, ""},
      {"at_fault", kFree, SessionStatus::kCompleted, 440, Touch::kEgoAtFault, true, true,
       Outcome::kFailed, 1,
       "the ego was at fault in 1 contact; at most 0 allowed: with background vehicle bg_9"},
      {"at_fault_attacked", kAttack, SessionStatus::kCompleted, 440, Touch::kEgoAtFault, true, true,
       Outcome::kFailed, 1, "the ego's front struck the other's rear"},
      {"unavoidable", kAttack, SessionStatus::kCompleted, 440, Touch::kUnavoidable, true, true,
       Outcome::kStruck, 0, "no braking of the ego would have avoided 1 contact, which excuses it"},
      {"unavoidable_in_peace", kFree, SessionStatus::kCompleted, 440, Touch::kUnavoidable, true,
       true, Outcome::kFailed, 1,
       "the ego was at fault in 1 contact; at most 0 allowed: with background vehicle bg_9"},
      {"struck", kFree, SessionStatus::kCompleted, 440, Touch::kEgoStruck, true, true,
       Outcome::kFailed, 1, "in mode naturalistic that counts as failed"},
      {"struck_attacked", kAttack, SessionStatus::kCompleted, 440, Touch::kEgoStruck, true, true,
       Outcome::kStruck, 0, "in mode safety_critical that counts as struck"},
      {"blocked", kAttack, SessionStatus::kBlocked, 440, Touch::kNone, true, true, Outcome::kFailed,
       1, "the session ended with status 'blocked'"},
      {"deviated", kAttack, SessionStatus::kDeviated, 440, Touch::kNone, true, true,
       Outcome::kFailed, 1, "the session ended with status 'deviated'"},
      {"timed_out_early", kAttack, SessionStatus::kTimedOut, kEarly, Touch::kNone, true, true,
       Outcome::kFailed, 1, "the ego completed 38.9 % of its route; at least 90 % is asked"},
      {"broken", kFree, SessionStatus::kError, kEarly, Touch::kNone, true, true, Outcome::kError, 2,
       "simulator: SUMO was lost"},
      {"interrupted", kFree, SessionStatus::kInterrupted, kEarly, Touch::kNone, true, true,
       Outcome::kInterrupted, 130, "status 'interrupted'"},
      {"no_rules", kFree, SessionStatus::kBlocked, kEarly, Touch::kEgoAtFault, false, true,
       Outcome::kNotJudged, 0, "the scenario has no rules"},
      {"not_to_be_judged", kFree, SessionStatus::kBlocked, kEarly, Touch::kEgoAtFault, true, false,
       Outcome::kNotJudged, 0, "verdict.judge is false"}};
  return cases;
}

inline session::ScenarioOptions optionsOf(const VerdictCase& wanted) {
  session::ScenarioOptions options = sampleOptions();
  options.name = wanted.name;
  options.mode = wanted.mode;
  if (wanted.rules) options.verdict = session::VerdictOptions::standard();
  options.verdict.judge = wanted.judge;
  return options;
}

/// bg_9 stands 4.4 m ahead of the ego at 5 s, since 2 s or (unavoidable) since the tick before, or
/// comes from 4.4 m behind it at 12 m/s: boxes of 4.5 m that were 0.3 m or 0.1 m apart at the tick
/// before.
inline void addTouch(traffic::TrafficSnapshot& snapshot, Touch touch) {
  constexpr std::uint64_t kTick = 100;
  const std::uint64_t first = touch == Touch::kEgoAtFault ? 40 : kTick - 1;
  if (touch == Touch::kNone || snapshot.tick < first || snapshot.tick > kTick) return;
  const bool strikes = touch == Touch::kEgoStruck;
  const double back = 0.05 * static_cast<double>(kTick - snapshot.tick);  // [s]
  const double speed = strikes ? 12.0 : 0.0;
  const double x = 5.0 + 8.0 * 5.0 + (strikes ? -4.4 : 4.4) - speed * back;
  snapshot.vehicles.push_back(
      sampleVehicle("bg_9", traffic::VehicleRole::kBackground, {x, -2.0}, 0.0, speed));
  if (snapshot.tick == kTick) snapshot.contacts = {{"bg_9", "ego"}};
}

/// Shows the whole session to the observer.
inline void playCase(session::SessionObserver& observer, const VerdictCase& wanted) {
  for (std::uint64_t tick = 0; tick <= wanted.last_tick; ++tick) {
    traffic::TrafficSnapshot snapshot = sampleSnapshot(tick);
    for (traffic::Vehicle& vehicle : snapshot.vehicles) {
      if (vehicle.role == traffic::VehicleRole::kCbv)
        vehicle.role = traffic::VehicleRole::kBackground;
    }
    addTouch(snapshot, wanted.touch);
    if (tick == wanted.last_tick) snapshot.status = wanted.status;
    if (tick == wanted.last_tick && wanted.status == traffic::SessionStatus::kError)
      snapshot.faults = {{tick, "simulator", "SUMO was lost"}};
    session::TickRecord record;
    record.snapshot = &snapshot;
    observer.observe(record);
  }
}

}  // namespace cdiff::test
