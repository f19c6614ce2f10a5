// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "evaluation/matrix.h"

namespace cdiff::evaluation {

/// The level of `routes:` that stands for the ten routes on which RIFT and the paper report (their
/// development set of Bench2Drive, drivetransformer_bench2drive_dev10.xml).
constexpr const char* kDev10 = "dev10";

/// Ids of these ten routes, sorted.
const std::vector<std::string>& dev10Routes();

/// Which routes of a Bench2Drive file an evaluation runs: each place once.
struct Bench2DriveSelection {
  std::vector<std::pair<std::string, std::string>> routes;  ///< id, network file
  /// Left out because of waypoints equal to those of a route that is run: by id, the id of that
  /// one.
  std::map<std::string, std::string> repeated;
};

/// Throws InputError for a named route that the file or its town's network does not have, and for a
/// selection without any route. Of dev10, routes in other towns are left out.
Bench2DriveSelection selectBench2Drive(const Bench2DriveOptions& options);

/// "left out ..." for people; empty where nothing was.
std::string repeatedText(const Bench2DriveSelection& selection);

/// Name of a suite that is given by name or by its folder, with a slash at the end or without.
std::string suiteName(const std::string& name_or_folder);

// Opening a sealed suite (suite/seal.h) in an evaluation: only with a reason, and on record.

/// Names of the sealed suites that a matrix runs, by its suite or by single scenarios; sorted.
/// Throws InputError when one of them differs from its seal.
std::vector<std::string> sealedSuitesOf(const MatrixOptions& matrix);

/// Throws InputError when the matrix runs a sealed suite without a reason, or has a reason and runs
/// none. `source` names the matrix.
void requireOpeningReason(const MatrixOptions& matrix, const std::string& source);

/// For a matrix that runs sealed suites: appends a line each to RESULTS/opened.log (date and time
/// UTC, suite, SHA-256 of its seal, matrix, reason) and returns the reminder to add it to
/// docs/sealed_suites.md; otherwise an empty text.
std::string recordOpening(const MatrixOptions& matrix, const std::filesystem::path& results);

}  // namespace cdiff::evaluation
