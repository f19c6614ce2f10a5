// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "evaluation/matrix.h"

namespace cdiff::evaluation {

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
