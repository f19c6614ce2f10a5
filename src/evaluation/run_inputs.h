// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What a run's figures depend on besides its resolved scenario: the content of the files that the
/// scenario names, and the program. A finished run stays in a resumed batch only while all of it is
/// the same.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include "session/scenario_options.h"

namespace cdiff::evaluation {

/// SHA-256 by name: "network", "demand", "route_file", "speed_target", "ego_weights", "cbv_weights"
/// (where the scenario has them) and "program".
using InputHashes = std::map<std::string, std::string>;

/// Hashes each file once.
class InputHasher {
 public:
  /// Throws InputError naming a file or model that cannot be read.
  InputHashes hashes(const session::ScenarioOptions& options);

 private:
  const std::string& ofFile(const std::filesystem::path& file, const std::string& what);
  const std::string& ofNetwork(const planning::PlannerDescriptor& planner,
                               const session::ScenarioOptions& options);
  std::map<std::string, std::string> files_;
  std::map<std::pair<std::string, std::string>, std::string> models_;  ///< by planner and model
};

/// SHA-256 of this program and those of its libraries that are ours. Package version and revision
/// would not tell a build with changed sources from the one before.
const std::string& programSha256();

/// Names of the inputs that differ, or are on one side only, joined by ", "; empty when none does.
std::string changedInputs(const InputHashes& before, const InputHashes& now);

}  // namespace cdiff::evaluation
