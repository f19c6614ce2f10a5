// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "suite/suite_route.h"

namespace cdiff::suite {

/// A route suite: a folder with suite.yaml (its routes), networks/NAME/ and scenarios/ROUTE.yaml.
struct Suite {
  std::string name;
  std::int64_t seed = 1;  ///< root seed from which it was generated
  bool sealed = false;    ///< no choice of design or setting may be made on it; see seal.h
  std::vector<SuiteRoute> routes;
  std::filesystem::path folder;

  std::filesystem::path networkFile(const SuiteRoute& route) const;
  std::filesystem::path scenarioFile(const SuiteRoute& route) const;
};

/// Reads a suite by its folder, or by the name of one in config/suites. Throws InputError that
/// names the nearest shipped suite, the manifest's line and key, the route whose network or
/// scenario file is missing, or the file of a sealed suite that differs from its seal.
Suite loadSuite(const std::string& name_or_folder);

/// Scenario files of its routes, in their order.
std::vector<std::string> scenarioFiles(const Suite& suite);

/// Names of the shipped suites, sorted.
std::vector<std::string> shippedSuites();

// What is held out of all training: sealed suites, and those that ship with the package, wherever a
// copy of them lies.

/// Throws InputError naming the suite when it is held out. Called by everything that trains on
/// routes.
void requireForTraining(const Suite& suite);
/// The same for the suites to which scenario files, SUITE/scenarios/NAME.yaml, belong; names of
/// scenarios and other files belong to none. Called by everything that makes training data.
void requireForTraining(const std::vector<std::string>& scenarios);

/// Text of the manifest suite.yaml, one line per route.
std::string manifestText(const Suite& suite);

}  // namespace cdiff::suite
