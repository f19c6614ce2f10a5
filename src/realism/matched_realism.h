// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/run_record.h"
#include "evaluation/statistics.h"
#include "realism/continuation.h"

namespace cdiff::realism {

/// realism_matched: the meta-metric of Waymo's Sim Agents Challenge 2025 on the sessions of a
/// matrix, for each of its drivers of CBVs, for SUMO's, and for PDM-Lite against itself, the
/// ceiling. The evaluated objects are the CBVs of the first hand-over.
/// One driver in one session.
struct MatchedJob {
  std::string driver;          ///< row of the table
  std::string planner;         ///< that drives; empty: SUMO
  evaluation::PlannedRun run;  ///< its command is `cdiff realism continue`
};

/// A job for each run, and one of SUMO for each scenario and seed. Throws InputError for runs that
/// differ in the ego's planner.
std::vector<MatchedJob> planMatched(const std::vector<evaluation::PlannedRun>& runs,
                                    const ContinuationOptions& options);

/// How a job ended.
struct MatchedEnd {
  std::optional<ContinuationScore> score;  ///< absent for a job that broke or was stopped
  std::string cause;                       ///< why there is none
};

/// How the jobs ended, in their order; `records`: what an engine gives of their runs. Throws
/// InputError naming a score that cannot be read.
std::vector<MatchedEnd> endsOf(const std::vector<evaluation::RunRecord>& records,
                               const std::filesystem::path& results);

std::string scoreJson(const ContinuationScore& score);
/// Throws InputError naming the file.
ContinuationScore readScore(const std::filesystem::path& file);

/// One driver over all sessions.
struct MatchedRow {
  std::string driver;
  bool ceiling = false;        ///< PDM-Lite against itself
  std::size_t hand_overs = 0;  ///< sessions that count
  std::size_t without = 0;     ///< sessions without a hand-over
  std::size_t broken = 0;
  Likelihoods likelihoods;      ///< means over the sessions
  evaluation::Statistics meta;  ///< of the means of each scenario's sessions
};

/// Rows in the order of the first jobs. Throws InputError where drivers of one scenario and seed
/// have different hand-overs: the matrix then changes more than who drives.
std::vector<MatchedRow> matchedRows(const std::vector<MatchedJob>& jobs,
                                    const std::vector<MatchedEnd>& ends);

}  // namespace cdiff::realism
