// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/scenario/protocol.h"

#include <algorithm>

namespace cdiff::scenario {

using traffic::SessionStatus;

void ProtocolOptions::describe(core::OptionsVisitor& visitor) {
  visitor.text({"preset", "", "Name of the rules."}, preset, {"rift_dev10"});
  visitor.number({"time_limit", "s", "Simulated time after which the session has timed out."},
                 time_limit, 0.1, 86400.0);
  visitor.number({"blocked_time", "s", "Standing this long ends the session as blocked."},
                 blocked_time, 0.1, 86400.0);
  visitor.number({"blocked_speed", "m/s", "Slower than this counts as standing."}, blocked_speed,
                 0.0, 5.0);
  visitor.number(
      {"deviation_distance", "m", "Farther from the ego route ends the session as deviated."},
      deviation_distance, 1.0, 1000.0);
  visitor.number({"completion_percent", "%", "Share of the route that counts as complete."},
                 completion_percent, 1.0, 100.0);
  visitor.number(
      {"completion_distance", "m", "Largest distance to the route's end for completion."},
      completion_distance, 0.1, 100.0);
  visitor.flag({"end_on_collision", "", "Whether the ego's first contact ends the session."},
               end_on_collision);
}

ProtocolMonitor::ProtocolMonitor(const ProtocolOptions& options, const map::Route& route)
    : options_(options),
      progress_(route, options.completion_percent, options.completion_distance) {}

SessionStatus ProtocolMonitor::update(const traffic::TrafficSnapshot& snapshot) {
  const traffic::Vehicle* ego = snapshot.ego();
  if (ego == nullptr) return SessionStatus::kError;
  progress_.update(ego->state.position);
  const auto of_ego = [&](const traffic::Contact& contact) {
    return contact.first == ego->id || contact.second == ego->id;
  };
  const bool contact = std::any_of(snapshot.contacts.begin(), snapshot.contacts.end(), of_ego);
  if (options_.end_on_collision && contact) return SessionStatus::kCollided;
  if (progress_.percent() >= 100.0) return SessionStatus::kCompleted;
  if (progress_.deviation() > options_.deviation_distance) return SessionStatus::kDeviated;
  if (ego->state.speed >= options_.blocked_speed)
    standing_since_ = -1.0;
  else if (standing_since_ < 0.0)
    standing_since_ = snapshot.time;
  constexpr double kRounding = 1e-9;
  const bool standing = standing_since_ >= 0.0;
  if (standing && snapshot.time - standing_since_ >= options_.blocked_time - kRounding)
    return SessionStatus::kBlocked;
  if (snapshot.time >= options_.time_limit - kRounding) return SessionStatus::kTimedOut;
  return SessionStatus::kRunning;
}

}  // namespace cdiff::scenario
