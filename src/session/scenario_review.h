// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "session/session_setup.h"

namespace cdiff::session {

// What a user should know of a scenario that is valid: what is seldom meant, and how its traffic
// does on the simulator.

/// Whether the session can fail: some rule of its verdict is set and applied.
bool hasRules(const VerdictOptions& verdict);

/// Time that the ego needs along its route at its target speed, or the lanes' limits where they are
/// lower [s].
double drivingTime(const ScenarioOptions& options, const map::Route& route);

/// One sentence for each thing that is allowed and seldom meant: no rules, a route that takes
/// longer than the time limit, a demand file with far more vehicles than the network holds. Each
/// says what to do.
std::vector<std::string> scenarioWarnings(const SessionSetup& setup);

/// What a scenario's traffic did on the simulator, without the ego.
struct TrafficTrial {
  double simulated = 0.0;  ///< [s]
  double wall = 0.0;       ///< [s]
  std::size_t most = 0;    ///< vehicles at a time
  double asked = 0.0;      ///< vehicles that a demand file has depart in that time
};

/// Starts SUMO with the network and drives the traffic alone: generated traffic up to the session's
/// start, a demand file also through the session, for at most `patience` [s of wall time]. Throws
/// InputError naming the file that SUMO refuses, and SimulatorError.
TrafficTrial tryTraffic(const SessionSetup& setup, double patience);

/// One sentence for each thing about the trial that is seldom meant: no vehicle came, the roads do
/// not hold what the demand asks for, or SUMO is slower than real time.
std::vector<std::string> trialWarnings(const ScenarioOptions& options, const TrafficTrial& trial);

}  // namespace cdiff::session
