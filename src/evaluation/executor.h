// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "evaluation/run_record.h"

namespace cdiff::evaluation {

/// How `cdiff evaluate` runs planned sessions in parallel processes: time-out, retries, what an
/// earlier batch leaves to do, and whom it informs.
struct ExecutorOptions {
  std::filesystem::path program =
      "/proc/self/exe";  ///< understands `run FILE --quiet --results DIR --overwrite`
  /// Arguments that make the program a server for sessions, which starts once and forks a child for
  /// each (core/fork_server.h); empty: the program starts afresh for each.
  std::vector<std::string> server = {};
  std::filesystem::path results;  ///< result folder of the batch
  int jobs = 1;                   ///< processes at a time
  double timeout = 600.0;         ///< wall time of one attempt [s]
  int retries = 1;                ///< further attempts where a process or its simulator died
  double grace = 20.0;            ///< to end in after an interrupt [s]
  bool resume = false;  ///< complete records of the same scenario, inputs and program stay
  /// Runs that are run now; the others keep their record, or get one that says not_run. None: all.
  std::function<bool(const PlannedRun&)> chosen = {};
  /// Called before the first run for each cause to repeat runs that have a record, with their ids.
  std::function<void(const std::string& cause, const std::vector<std::string>& ids)> repeated = {};
  /// Called after each record is written, and for each that stays.
  std::function<void(const RunRecord&, bool resumed)> ended = {};
};

/// Folder of a run: RESULTS/runs/ID.
std::filesystem::path runFolder(const std::filesystem::path& results, const std::string& id);

/// Record of every planned run, in their order, whatever happened to it. They are run in the
/// order of runOrder(). Once `stop` is true no run
/// is started and those under way are interrupted.
std::vector<RunRecord> executeRuns(const std::vector<PlannedRun>& plan,
                                   const ExecutorOptions& options, const std::atomic<bool>& stop);

}  // namespace cdiff::evaluation
