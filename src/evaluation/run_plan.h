// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The runs of a matrix in a fixed order, each with its factors and its resolved scenario: wrong
/// input is found here, before anything runs.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "evaluation/matrix.h"
#include "evaluation/run_inputs.h"

namespace cdiff::evaluation {

/// Level of every factor by name (see factorNames).
using Factors = std::map<std::string, std::string>;

/// "scenario", "ego_planner", "cbv_planner", "mode", "guidance_profile", "variant", "seed",
/// "repetition".
const std::vector<std::string>& factorNames();

struct PlannedRun {
  std::string id;  ///< name of its folder; made of the factors that vary
  Factors factors;
  std::string scenario_text;    ///< resolved, as YAML
  std::string scenario_sha256;  ///< of that text
  InputHashes inputs;           ///< of what it depends on besides
};

/// Scenarios outermost, repetitions innermost. `source` names the matrix in errors. Throws
/// InputError for an empty matrix, one of more than 100,000 runs, an unknown scenario, planner or
/// profile, a seed that is no whole number, a variant that is not "name: key=value ...", and
/// everything a scenario can have wrong.
std::vector<PlannedRun> planRuns(const MatrixOptions& matrix, const std::string& source);

}  // namespace cdiff::evaluation
