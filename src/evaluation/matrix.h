// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "session/session_request.h"

namespace cdiff::evaluation {

// An evaluation: which sessions a batch runs, as one YAML file. Every list is a factor; the batch
// is the product of all of them.

/// Routes of a Bench2Drive file, each a scenario of its own.
struct Bench2DriveOptions {
  std::string file;
  std::string networks;             ///< folder with TOWN.net.xml files
  std::vector<std::string> routes;  ///< ids, or dev10; empty: all in the towns at hand

  void describe(core::OptionsVisitor& visitor);
};

/// An empty list leaves that factor as each scenario has it.
struct MatrixOptions {
  std::int64_t schema_version = 1;
  std::string name = "evaluation";
  std::vector<std::string> scenarios;  ///< shipped names or files
  std::string suite;                   ///< name or folder of a route suite; each route a scenario
  std::string open_sealed;             ///< why a sealed suite is opened; empty: none may be
  Bench2DriveOptions bench2drive;
  std::vector<std::string> ego_planners;
  std::vector<std::string> cbv_planners;
  std::vector<std::string> modes;
  std::vector<std::string> methods;
  std::vector<std::string> guidance_profiles;
  /// "ego_planner=NAME cbv_planner=NAME mode=MODE method=NAME guidance_profile=NAME" each, any of
  /// the five: instead of the product of those lists.
  std::vector<std::string> combinations;
  std::vector<std::string> variants;  ///< "name: key=value key=value" each
  std::vector<std::string> seeds;     ///< whole numbers
  std::int64_t repetitions = 1;
  std::vector<std::string> set;  ///< "key=value" each, for every run
  bool ego_ranking = false;      ///< also write ego_ranking.html
  double timeout = 600.0;        ///< wall time of one run [s]
  std::int64_t retries = 1;      ///< how often a run whose simulator or process died is repeated

  void describe(core::OptionsVisitor& visitor);
};

/// Reads a matrix by file name or by the name of one in config/evaluations. Files in it are
/// resolved against its folder. Throws InputError naming file, line and key, or the nearest shipped
/// one.
MatrixOptions loadMatrix(const std::string& name_or_file);

/// Names of the shipped matrices, sorted.
std::vector<std::string> shippedMatrices();

/// The matrix as text without what may change between a batch and its resumption (time-out,
/// retries, why a sealed suite is opened): equal texts plan the same runs.
std::string identityOf(const MatrixOptions& matrix);

// The levels of a matrix's factors, checked. `source` names the matrix in errors; all throw
// InputError.

/// Of a matrix; more would take minutes to plan and months to run.
constexpr std::size_t kMostRuns = 100000;

/// One level of the factor scenario.
struct ScenarioLevel {
  std::string label;
  session::SessionRequest request;
};

/// A named set of overrides under which every run of the matrix is repeated.
struct Variant {
  std::string name;
  std::vector<std::string> set;
};

/// Levels of the factors that are chosen together.
struct Combination {
  std::string ego_planner;
  std::string cbv_planner;
  std::string mode;
  std::string method;
  std::string guidance_profile;
  std::string variant = {};  ///< that it is run with, alone; empty: all that no combination names
};

/// Scenarios named, then those of the suite, then Bench2Drive routes; at least one.
std::vector<ScenarioLevel> scenarioLevels(const MatrixOptions& matrix, const std::string& source);

/// One without a name where the matrix has none.
std::vector<Variant> variantsOf(const MatrixOptions& matrix, const std::string& source);

/// Those given, or the product of the five lists.
std::vector<Combination> combinationsOf(const MatrixOptions& matrix, const std::string& source);

/// Names of variants that combinations name; each is one of `variants`.
std::set<std::string> namedVariants(const std::vector<Combination>& combinations,
                                    const std::vector<Variant>& variants,
                                    const std::string& source);

/// What a combination is run with: the variant that it names, else all that are not in `named`; one
/// without a name where that leaves nothing.
std::vector<Variant> variantsFor(const Combination& combination,
                                 const std::vector<Variant>& variants,
                                 const std::set<std::string>& named);

/// Whole numbers from 0 on.
void checkSeeds(const std::vector<std::string>& seeds, const std::string& source);

}  // namespace cdiff::evaluation
