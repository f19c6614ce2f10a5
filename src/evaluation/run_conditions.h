// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "evaluation/run_record.h"
#include "session/scenario_options.h"

namespace cdiff::evaluation {

/// The protocol that a run was driven by.
struct RunProtocol {
  std::string text;                           ///< "rift_dev10, time limit 40 s"
  std::map<std::string, std::string> values;  ///< of all keys of the group `protocol`
};

/// A resolved scenario: the value of each field as YAML, by its full key.
using Settings = std::map<std::string, std::string>;

/// The conditions under which the runs of a result folder were driven.
struct BatchConditions {
  std::string suite;                             ///< name of the route suite; empty: none
  std::map<std::string, RunProtocol> protocols;  ///< of complete runs, by id
  std::map<std::string, std::shared_ptr<const Settings>> settings;  ///< likewise
};

/// From matrix.yaml and each complete run's scenario.yaml. Throws InputError naming a file that is
/// absent or cannot be read.
BatchConditions readConditions(const std::filesystem::path& results,
                               const std::vector<RunRecord>& records);

/// "protocol rift_dev10, time limit 40 s; suite test", several protocols joined by " and ".
std::string conditionsText(const BatchConditions& conditions,
                           const std::vector<RunRecord>& records);

/// A set of runs, its name, and under what its runs were driven.
struct RunSet {
  std::string name;
  std::vector<RunRecord> records;
  BatchConditions conditions = {};
};

/// All of a result folder. Throws InputError as readRecords and readConditions do.
RunSet readRunSet(const std::filesystem::path& results);

/// Throws InputError with the reason and what to do where the sets have other suites, or where runs
/// of one scenario have other protocols, time limits or inputs in A than in B.
void requireComparable(const RunSet& a, const RunSet& b);

/// How the planners of a run work, for the heads of tables: for ego and CBVs with a network the
/// method, sampler, candidates, conditioning and weights; for guided ones the objectives with their
/// weights; then the protocol with its time limit [s]. Equal texts stand for equal settings.
std::string settingsOf(const session::ScenarioOptions& scenario);

/// What the network of the CBVs' planner is given, in the planner's own words; empty without one.
std::string cbvConditioningOf(const session::ScenarioOptions& scenario);

}  // namespace cdiff::evaluation
