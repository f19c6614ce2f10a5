// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "session/scenario_review.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/text.h"
#include "session/demand_file.h"
#include "session/session_request.h"
#include "session/world.h"

namespace cdiff::session {
namespace {

/// How far the route is driven within a time [%].
double percentWithin(const ScenarioOptions& options, const map::Route& route, double limit) {
  const std::vector<double>& ends = route.path().arcLengths();
  double time = 0.0;
  for (std::size_t i = 1; i < ends.size(); ++i) {
    time += (ends[i] - ends[i - 1]) / std::min(options.target_speed, route.speedLimitAt(ends[i]));
    if (time > limit) return 100.0 * ends[i - 1] / route.length();
  }
  return 100.0;
}

std::string timeWarning(const SessionSetup& setup) {
  const ScenarioOptions& options = setup.options();
  const map::Route& route = setup.egoRoute();
  const double needed = drivingTime(options, route);
  const double limit = longestTime(options.protocol, route);
  if (needed <= limit) return "";
  return "the route cannot be driven in the time limit: " + core::formatFixed(route.length(), 0) +
         " m take " + core::formatFixed(needed, 0) + " s at target_speed " +
         core::formatNumber(options.target_speed) + " m/s and the lanes' limits, and the session " +
         "ends after " + core::formatFixed(limit, 0) + " s, at " +
         core::formatFixed(percentWithin(options, route, limit), 0) +
         " % at most; set a longer protocol.time_limit, or leave it out and set protocol.preset: " +
         kUsualProtocol + ", or give a shorter route";
}

/// Vehicles that the lanes for cars hold at a standstill.
double jamCapacity(const map::RoadNetwork& network) {
  constexpr double kJamSpacing = 7.5;  // a vehicle of 5 m and SUMO's gap of 2.5 m [m]
  double length = 0.0;
  for (const map::Lane& lane : network.lanes()) {
    if (lane.routable && !lane.internal) length += lane.centerline.length();
  }
  return length / kJamSpacing;
}

constexpr double kCrowd = 1000.0;  ///< vehicles of a demand file that no network is asked about

/// Of a demand file that asks for far more vehicles than the network holds, or than SUMO drives at
/// a useful speed.
std::string crowdWarning(const SessionSetup& setup) {
  constexpr double kMost = 20000.0;
  const ScenarioOptions& options = setup.options();
  if (!hasDemandFile(options)) return "";
  const double seconds = options.traffic.warm_up + longestTime(options.protocol, setup.egoRoute());
  const double asked =
      DemandFile(options.demand).vehicles(options.begin_time, options.begin_time + seconds);
  const double held = jamCapacity(setup.network());
  if (asked <= kCrowd || (asked <= held && asked <= kMost)) return "";
  return "demand '" + options.demand + "' has " + core::formatFixed(asked, 0) +
         " vehicles depart within the session's " + core::formatFixed(seconds, 0) +
         " s, and the network's lanes hold " + core::formatFixed(held, 0) +
         " bumper to bumper: the roads jam, the others wait outside, and the session is slow; "
         "give at most " +
         core::formatFixed(std::min(kMost, 0.2 * held), 0) + " for traffic that flows";
}

/// Drives what the demand file brings, without an ego.
TrafficTrial driveDemand(const SessionSetup& setup, double patience) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  const ScenarioOptions& options = setup.options();
  const double planned = options.traffic.warm_up + longestTime(options.protocol, setup.egoRoute());
  const auto steps = static_cast<int>(std::ceil(planned / options.simulation_step));
  const auto simulator = setup.makeSimulator();
  TrafficTrial trial;
  for (int i = 0; i < steps && trial.wall < patience; ++i) {
    simulator->step({});
    trial.most = std::max(trial.most, simulator->vehicles().size());
    trial.simulated += options.simulation_step;
    trial.wall = std::chrono::duration<double>(Clock::now() - begin).count();
  }
  trial.asked =
      DemandFile(options.demand).vehicles(options.begin_time, options.begin_time + trial.simulated);
  return trial;
}

}  // namespace

bool hasRules(const VerdictOptions& verdict) {
  return verdict.judge && core::dumpOptions(verdict) != core::dumpOptions(VerdictOptions());
}

double drivingTime(const ScenarioOptions& options, const map::Route& route) {
  const std::vector<double>& ends = route.path().arcLengths();
  double time = 0.0;
  for (std::size_t i = 1; i < ends.size(); ++i)
    time += (ends[i] - ends[i - 1]) / std::min(options.target_speed, route.speedLimitAt(ends[i]));
  return time;
}

std::vector<std::string> scenarioWarnings(const SessionSetup& setup) {
  std::vector<std::string> warnings = setup.ignoredElements();
  const VerdictOptions& verdict = setup.options().verdict;
  if (verdict.judge && !hasRules(verdict)) {
    warnings.emplace_back(
        "NO VERDICT RULES: no session of this scenario can fail, so exit code 0 means nothing; "
        "write the group 'verdict' (docs/protocols.md), or verdict.judge: false if that is meant");
  }
  const std::string time = timeWarning(setup);
  if (!time.empty()) warnings.push_back(time);
  const std::string crowd = crowdWarning(setup);
  if (!crowd.empty()) warnings.push_back(crowd);
  return warnings;
}

TrafficTrial tryTraffic(const SessionSetup& setup, double patience) {
  if (hasDemandFile(setup.options())) return driveDemand(setup, patience);
  const World world(setup);
  return {setup.options().traffic.warm_up, 0.0, world.snapshot().vehicles.size() - 1};
}

std::vector<std::string> trialWarnings(const ScenarioOptions& options, const TrafficTrial& trial) {
  std::vector<std::string> warnings;
  if (trial.most == 0 && options.demand != "none") {
    warnings.push_back(
        "no vehicle drives in the first " + core::formatFixed(trial.simulated, 0) + " s" +
        (hasDemandFile(options) ? "; vehicles that depart before begin_time (" +
                                      core::formatNumber(options.begin_time) + " s) are dropped"
                                : ": there is no room near the ego's route"));
  }
  if (trial.asked > kCrowd && trial.asked > 4.0 * static_cast<double>(trial.most)) {
    warnings.push_back("the demand has " + core::formatFixed(trial.asked, 0) +
                       " vehicles depart in the first " + core::formatFixed(trial.simulated, 0) +
                       " s, and the roads hold " + std::to_string(trial.most) +
                       " of them: the others wait outside; give fewer");
  }
  if (trial.wall > trial.simulated && trial.most > 0) {
    warnings.push_back("SUMO alone needs " + core::formatFixed(trial.wall, 0) + " s for " +
                       core::formatFixed(trial.simulated, 0) + " s of this demand, with " +
                       std::to_string(trial.most) + " vehicles at a time: a session will be slow");
  }
  return warnings;
}

}  // namespace cdiff::session
