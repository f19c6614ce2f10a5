// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/run_plan.h"
#include "record/outcome.h"

namespace cdiff::evaluation {

// The measures that a batch takes from a session's summary.json, by fixed names.

/// Values by name; a measure that a session does not have is not there.
using Measures = std::map<std::string, double>;

/// Of how many vehicles were selected as CBV; one selected twice counts twice.
inline constexpr const char* kSelectionCount = "cbv_selections";

/// All names in the order of columns.
const std::vector<std::string>& measureNames();

/// What a summary says.
struct SummaryFacts {
  std::string status;
  std::string fault;  ///< text of the last fault, or empty
  record::Outcome verdict = record::Outcome::kError;
  std::vector<std::string> reasons;     ///< reasons of the verdict
  std::vector<std::string> decided_by;  ///< rules that decided it
  double simulated_seconds = 0.0;
  Measures measures;
};

/// Throws InputError naming `source` for a text that is not a summary, and for that of a session
/// that was steered by hand, which no table may hold.
SummaryFacts readSummary(const std::string& text, const std::string& source);

/// Name of a run's record in its folder.
inline constexpr const char* kRecordFile = "record.json";

/// What happened to one planned run: kRecordFile in its folder, written whole before the batch
/// starts (not_run) and again after the run.
struct RunRecord {
  std::string id;
  Factors factors;
  std::string scenario_sha256;
  InputHashes inputs;  ///< empty in a record of an earlier version
  RunCommand command;
  std::string status = "not_run";  ///< status of the session; or "error", "interrupted", "not_run"
  std::string cause;               ///< cause of an error
  int exit_code = -1;
  int attempts = 0;
  double wall_seconds = 0.0;  ///< duration of the last attempt
  double simulated_seconds = 0.0;
  record::Outcome verdict =
      record::Outcome::kError;          ///< verdict on a session that ended by its own rules
  std::vector<std::string> reasons;     ///< reasons of the verdict
  std::vector<std::string> decided_by;  ///< rules that decided it
  Measures measures;                    ///< measures of a session that ended by its own rules

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

/// Whether the scenario of a run, or a file of it, is another one by now; weights and program are
/// none of it, and a record of an earlier version knows no files.
bool isOfAnotherScenario(const RunRecord& earlier, const PlannedRun& planned);

/// The record of a run that was not started yet.
RunRecord recordOf(const PlannedRun& run);

std::string recordJson(const RunRecord& record);
/// nullopt when the file is absent. Throws InputError naming a file that is not a record.
std::optional<RunRecord> readRecord(const std::filesystem::path& file);
/// Records of the sessions in a batch's result folder by id. Throws InputError when it holds none,
/// or one that is damaged.
std::vector<RunRecord> readRecords(const std::filesystem::path& results);

/// A contact of the ego, as a run's summary.json has it.
struct RunContact {
  double seconds = 0.0;  ///< time in the session [s]
  std::string partner;   ///< id of the other vehicle
  bool ego_at_fault = false;
  std::string why;                 ///< who struck whom, in a short sentence
  double ego_speed = 0.0;          ///< [m/s]
  double other_speed = 0.0;        ///< [m/s]
  std::optional<bool> with_cbv{};  ///< else with background traffic; absent: not recorded

  /// Whether the ego stood when it was struck: slower than 0.1 m/s.
  bool egoStood() const { return ego_speed < 0.1; }
  /// "CBV bg_1", "background vehicle bg_7".
  std::string partnerText() const;
};

/// In order of time; empty for a summary of a version without them. Throws InputError naming
/// `source` for a text that is no summary.
std::vector<RunContact> contactsIn(const std::string& text, const std::string& source);

/// Numbers of a summary.json by JSON pointer (`MeasureDefinition::place`); lists are left out.
using SummaryNumbers = std::map<std::string, double>;

/// Throws InputError naming `source` for a text that is not a JSON object.
SummaryNumbers summaryNumbers(const std::string& text, const std::string& source);

/// The runs of a batch with all numbers of their summaries, from which tables and figures are made.
struct BatchRun {
  RunRecord record;
  std::filesystem::path folder;
  SummaryNumbers numbers;              ///< empty unless the run is complete
  std::string settings{};              ///< see settingsOf; empty unless the run is complete
  std::string cbv_conditioning{};      ///< see cbvConditioningOf; likewise
  std::vector<RunContact> contacts{};  ///< of the ego

  /// Value at a JSON pointer; nullopt where the summary has no number there.
  std::optional<double> number(const std::string& pointer) const;
};

/// The resolved scenario of a run. Throws InputError when it cannot be read.
session::ScenarioOptions scenarioOf(const BatchRun& run);

/// Every record of a result folder, by id. Throws InputError for a folder without records, a
/// damaged record or a damaged summary.
std::vector<BatchRun> readBatchRuns(const std::filesystem::path& results);

/// Tables, figures and findings pool runs over scenarios and seeds, never over variants: of
/// several, the runs without one count, else those of the first by name. Rows that name a variant
/// have its runs.
std::string pooledVariant(const std::vector<BatchRun>& runs);

/// Whether the run has all these levels.
bool hasLevels(const RunRecord& record, const Factors& levels);

/// Runs with these levels, complete or not, in order.
std::vector<const BatchRun*> runsWith(const std::vector<BatchRun>& runs, const Factors& levels);

}  // namespace cdiff::evaluation
