// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What became of one planned run: record.json in its folder, written whole before the batch begins
/// (not_run) and again after the run.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/figures.h"
#include "evaluation/run_plan.h"

namespace cdiff::evaluation {

struct RunRecord {
  std::string id;
  Factors factors;
  std::string scenario_sha256;
  InputHashes inputs;              ///< empty in a record of an earlier version
  std::string status = "not_run";  ///< of the session; or "error", "interrupted", "not_run"
  std::string cause;               ///< of an error
  int exit_code = -1;
  int attempts = 0;
  double wall_seconds = 0.0;  ///< of the last attempt
  double simulated_seconds = 0.0;
  record::Outcome verdict = record::Outcome::kError;  ///< of a session that ended by its own rules
  std::vector<std::string> reasons;                   ///< of the verdict
  std::vector<std::string> decided_by;                ///< rules that decided it
  Figures figures;                                    ///< of a session that ended by its own rules

  /// Whether the session ended by its own rules.
  bool complete() const;
  /// Whether the session ended by its own rules, with this verdict.
  bool has(record::Outcome outcome) const { return complete() && verdict == outcome; }
  /// Whether it was started, and broke.
  bool failed() const { return status == "error"; }
};

/// Why a run that has this record must be run again ("weights changed", "error"); empty when its
/// result stands.
std::string causeToRepeat(const RunRecord& earlier, const PlannedRun& planned);

/// The record of a run that was not started yet.
RunRecord recordOf(const PlannedRun& run);

std::string recordJson(const RunRecord& record);
/// nullopt when the file is absent. Throws InputError naming a file that is no record.
std::optional<RunRecord> readRecord(const std::filesystem::path& file);
/// Records of a batch's result folder by id. Throws InputError when it holds none, or one that is
/// damaged.
std::vector<RunRecord> readRecords(const std::filesystem::path& results);

}  // namespace cdiff::evaluation
