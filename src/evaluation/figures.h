// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The figures that a batch takes from a session's summary.json, by fixed names.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "record/verdict.h"

namespace cdiff::evaluation {

/// Values by name; a figure that a session does not have is not there.
using Figures = std::map<std::string, double>;

/// All names in the order of columns.
const std::vector<std::string>& figureNames();

/// What a summary says.
struct SummaryFacts {
  std::string status;
  std::string fault;  ///< text of the last fault, or empty
  record::Outcome verdict = record::Outcome::kError;
  std::vector<std::string> reasons;     ///< of the verdict
  std::vector<std::string> decided_by;  ///< rules that decided it
  double simulated_seconds = 0.0;
  Figures figures;
};

/// Throws InputError naming `source` for a text that is no summary.
SummaryFacts readSummary(const std::string& text, const std::string& source);

}  // namespace cdiff::evaluation
