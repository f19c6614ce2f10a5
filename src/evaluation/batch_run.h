// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The runs of a batch with all numbers of their summaries, from which tables and figures are made.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/run_record.h"

namespace cdiff::evaluation {

/// Numbers of a summary.json by JSON pointer (`FigureDefinition::place`); lists are left out.
using SummaryNumbers = std::map<std::string, double>;

/// Throws InputError naming `source` for a text that is no JSON object.
SummaryNumbers summaryNumbers(const std::string& text, const std::string& source);

struct BatchRun {
  RunRecord record;
  std::filesystem::path folder;
  SummaryNumbers numbers;  ///< empty unless the run is complete

  /// Value at a JSON pointer; nullopt where the summary has no number there.
  std::optional<double> number(const std::string& pointer) const;
};

/// Every record of a result folder, by id. Throws InputError for a folder without records, a
/// damaged record or a damaged summary.
std::vector<BatchRun> readBatchRuns(const std::filesystem::path& results);

/// Whether the run has all these levels.
bool hasLevels(const RunRecord& record, const Factors& levels);

/// Runs with these levels, complete or not, in order.
std::vector<const BatchRun*> runsWith(const std::vector<BatchRun>& runs, const Factors& levels);

}  // namespace cdiff::evaluation
