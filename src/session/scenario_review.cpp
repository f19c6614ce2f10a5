// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "session/scenario_review.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <pugixml.hpp>

#include "core/file.h"
#include "core/text.h"
#include "session/session_request.h"
#include "session/world.h"

namespace cdiff::session {
namespace {

bool hasDemandFile(const ScenarioOptions& options) {
  return options.demand != "generated" && options.demand != "none";
}

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
         " % at most; set protocol.time_limit, or protocol.preset: " + kUsualProtocol +
         ", or give a shorter route";
}

double numberOf(const pugi::xml_node& node, const char* attribute, double absent) {
  return core::parseNumber(node.attribute(attribute).value()).value_or(absent);
}

/// Vehicles of a flow from `begin` to `end` [s].
double vehiclesOfFlow(const pugi::xml_node& flow, double begin, double end) {
  const double from = numberOf(flow, "begin", 0.0);
  const double until = std::max(numberOf(flow, "end", 86400.0), from + 1e-3);
  const double share = std::max(0.0, std::min(end, until) - std::max(begin, from));
  const double period = numberOf(flow, "period", 0.0);
  if (flow.attribute("number")) return numberOf(flow, "number", 0.0) * share / (until - from);
  if (period > 0.0) return share / period;
  return share * (numberOf(flow, "vehsPerHour", 0.0) / 3600.0 + numberOf(flow, "probability", 0.0));
}

/// Vehicles that a demand file has depart from `begin` to `end` [s].
double vehiclesAsked(const std::string& file, double begin, double end) {
  const std::string text = core::readFile(file, "demand file");
  pugi::xml_document document;
  document.load_buffer(text.data(), text.size());
  double asked = 0.0;
  for (const pugi::xml_node& element : document.child("routes").children()) {
    const std::string kind = element.name();
    const double departure = numberOf(element, "depart", -1.0);
    if (kind == "flow") asked += vehiclesOfFlow(element, begin, end);
    if (kind == "vehicle" || kind == "trip") asked += departure >= begin && departure <= end;
  }
  return asked;
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
      vehiclesAsked(options.demand, options.begin_time, options.begin_time + trial.simulated);
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
  std::vector<std::string> warnings;
  const VerdictOptions& verdict = setup.options().verdict;
  if (verdict.judge && !hasRules(verdict)) {
    warnings.emplace_back(
        "NO VERDICT RULES: no session of this scenario can fail, so exit code 0 means nothing; "
        "write the group 'verdict' (docs/protocols.md), or verdict.judge: false if that is meant");
  }
  const std::string time = timeWarning(setup);
  if (!time.empty()) warnings.push_back(time);
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
  constexpr double kCrowd = 1000.0;
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
