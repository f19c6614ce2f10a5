// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/run_plan.h"
#include "evaluation/statistics.h"
#include "realism/continuation.h"

namespace cdiff::realism {

/// realism_matched: the meta-metric of Waymo's Sim Agents Challenge 2025 on the sessions of a
/// matrix, for each of its drivers of CBVs, for SUMO's, and for PDM-Lite against itself, the
/// ceiling. The evaluated objects are the CBVs of the first hand-over.
/// One driver in one session.
struct MatchedJob {
  std::string id;       ///< name of its folder
  std::string driver;   ///< row of the table
  std::string planner;  ///< that drives; empty: SUMO
  evaluation::PlannedRun run;
};

/// A job for each run, and one of SUMO for each scenario and seed. Throws InputError for runs that
/// differ in the ego's planner.
std::vector<MatchedJob> planMatched(const std::vector<evaluation::PlannedRun>& runs);

/// How a job ended.
struct MatchedEnd {
  std::optional<ContinuationScore> score;  ///< absent for a job that broke or was stopped
  std::string cause;                       ///< why there is none
  bool resumed = false;
};

/// How the jobs are run.
struct MatchedExecution {
  std::filesystem::path program =
      "/proc/self/exe";           ///< understands `realism continue FILE --driver NAME ...`
  std::filesystem::path results;  ///< result folder
  ContinuationOptions options;
  int jobs = 1;             ///< processes at a time
  double timeout = 3600.0;  ///< wall time of one job [s]
  bool resume = false;      ///< scores of the same job stay
  std::function<void(const MatchedJob&, const MatchedEnd&)> ended = {};
};

/// Ends in the order of jobs. Once `stop` is true no job is started.
std::vector<MatchedEnd> runMatched(const std::vector<MatchedJob>& jobs,
                                   const MatchedExecution& execution,
                                   const std::atomic<bool>& stop);

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
