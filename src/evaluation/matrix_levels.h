// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The levels of a matrix's factors, checked. `source` names the matrix in errors; all throw
/// InputError.
#pragma once

#include <string>
#include <vector>

#include "evaluation/matrix.h"
#include "session/session_request.h"

namespace cdiff::evaluation {

/// Of a matrix; more would take minutes to plan and months to run.
constexpr std::size_t kMostRuns = 100000;

/// One level of the factor scenario.
struct ScenarioLevel {
  std::string label;
  session::SessionRequest request;
};

struct Variant {
  std::string name;
  std::vector<std::string> set;
};

/// Levels of the factors that are chosen together.
struct Combination {
  std::string ego_planner;
  std::string cbv_planner;
  std::string mode;
  std::string guidance_profile;
};

/// Scenarios named, then those of the suite, then Bench2Drive routes; at least one.
std::vector<ScenarioLevel> scenarioLevels(const MatrixOptions& matrix, const std::string& source);

/// One without a name where the matrix has none.
std::vector<Variant> variantsOf(const MatrixOptions& matrix, const std::string& source);

/// Those given, or the product of the four lists.
std::vector<Combination> combinationsOf(const MatrixOptions& matrix, const std::string& source);

/// Whole numbers from 0 on.
void checkSeeds(const std::vector<std::string>& seeds, const std::string& source);

}  // namespace cdiff::evaluation
