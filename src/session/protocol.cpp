// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "session/protocol.h"

#include <algorithm>
#include <filesystem>

#include "core/file.h"
#include "session/preset_file.h"

namespace cdiff::session {
namespace {

namespace fs = std::filesystem;

constexpr double kRounding = 1e-9;  // of simulated times [s]

fs::path protocolFolder() { return core::shareFolder() / "config" / "protocols"; }

/// By which progress from one arc length to another moves the time limit [s].
double timeAllowed(const ProtocolOptions& options, const map::Route& route, double from,
                   double to) {
  if (options.time_limit_speed_percent <= 0.0 || to <= from) return 0.0;
  return (to - from) / (0.01 * options.time_limit_speed_percent * route.speedLimitAt(to));
}

}  // namespace

using traffic::SessionStatus;

void ProtocolOptions::describe(core::OptionsVisitor& visitor) {
  visitor.text({"preset", "", "Rules whose values the keys below have unless given."}, preset,
               shippedProtocols());
  visitor.number({"time_limit", "s",
                  "Simulated time after which the session has timed out. Given in a scenario, it "
                  "holds as given, whatever the preset says of its growth."},
                 time_limit, 0.1, 86400.0);
  visitor.number({"time_limit_speed_percent", "%",
                  "The time limit grows by the time that the progress takes at this share of the "
                  "lanes' limits; 0: it is fixed, as it is where time_limit alone is given."},
                 time_limit_speed_percent, 0.0, 100.0);
  visitor.number({"blocked_time", "s", "Standing this long ends the session as blocked."},
                 blocked_time, 0.1, 86400.0);
  visitor.number({"blocked_speed", "m/s", "Slower than this counts as standing."}, blocked_speed,
                 0.0, 5.0);
  visitor.number(
      {"deviation_distance", "m", "Farther from the ego route ends the session as deviated."},
      deviation_distance, 1.0, 1000.0);
  visitor.number({"deviation_safe_distance", "m",
                  "Progress made at this distance from the ego route, or farther, is limited."},
                 deviation_safe_distance, 0.1, 1000.0);
  visitor.number({"deviation_percent", "%",
                  "More of the route driven that far away ends the session as deviated."},
                 deviation_percent, 0.0, 100.0);
  visitor.number({"completion_percent", "%", "Share of the route that counts as complete."},
                 completion_percent, 1.0, 100.0);
  visitor.number(
      {"completion_distance", "m", "Largest distance to the route's end for completion."},
      completion_distance, 0.1, 100.0);
  visitor.flag({"end_on_collision", "", "Whether the ego's first contact ends the session."},
               end_on_collision);
  infractions.describe(visitor);
}

ProtocolOptions loadProtocol(const std::string& preset) {
  auto options = loadPreset<ProtocolOptions>(protocolFolder(), preset,
                                             "protocol preset '" + preset + "' is not known");
  options.preset = preset;
  return options;
}

std::vector<std::string> shippedProtocols() { return core::shippedNames(protocolFolder()); }

double longestTime(const ProtocolOptions& options, const map::Route& route) {
  double time = options.time_limit;
  const std::vector<double>& ends = route.path().arcLengths();
  for (std::size_t i = 1; i < ends.size(); ++i)
    time += timeAllowed(options, route, ends[i - 1], ends[i]);
  return time;
}

ProtocolMonitor::ProtocolMonitor(const ProtocolOptions& options, const map::Route& route)
    : options_(options),
      route_(&route),
      progress_(route, options.completion_percent, options.completion_distance),
      time_limit_(options.time_limit) {}

SessionStatus ProtocolMonitor::update(const traffic::TrafficSnapshot& snapshot) {
  const traffic::Vehicle* ego = snapshot.ego();
  if (ego == nullptr) return SessionStatus::kError;
  const double before = progress_.arcLength();
  progress_.update(ego->state.position);
  time_limit_ += timeAllowed(options_, *route_, before, progress_.arcLength());
  const auto of_ego = [&](const traffic::Contact& contact) {
    return contact.first == ego->id || contact.second == ego->id;
  };
  const bool contact = std::any_of(snapshot.contacts.begin(), snapshot.contacts.end(), of_ego);
  const bool deviated = deviates(progress_.arcLength() - before);
  const bool blocked = stands(snapshot.time, ego->state.speed);
  if (options_.end_on_collision && contact) return SessionStatus::kCollided;
  if (progress_.percent() >= 100.0) return SessionStatus::kCompleted;
  if (deviated) return SessionStatus::kDeviated;
  if (blocked && !blocked_withheld_) return SessionStatus::kBlocked;
  if (snapshot.time >= time_limit_ - kRounding) return SessionStatus::kTimedOut;
  return SessionStatus::kRunning;
}

bool ProtocolMonitor::deviates(double advance) {
  const double deviation = progress_.deviation();
  if (deviation >= options_.deviation_safe_distance) deviated_distance_ += advance;
  const double allowed = 0.01 * options_.deviation_percent * route_->length();
  return deviation > options_.deviation_distance || deviated_distance_ > allowed;
}

bool ProtocolMonitor::stands(double time, double speed) {
  if (speed >= options_.blocked_speed)
    standing_since_.reset();
  else if (!standing_since_)
    standing_since_ = time;
  return standing_since_ && time - *standing_since_ >= options_.blocked_time - kRounding;
}

}  // namespace cdiff::session
