// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <atomic>
#include <cstddef>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "evaluation/run_record.h"
#include "evaluation/worker.h"

namespace cdiff::evaluation {

/// How a command runs a plan: how its workers do, what an earlier batch leaves to do, and
/// whom it informs.
struct ExecutorOptions : WorkerOptions {
  bool resume = false;  ///< complete records of the same scenario, inputs and program stay
  /// Runs that are run now; the others keep their record, or get one that says not_run. None: all.
  std::function<bool(const PlannedRun&)> chosen = {};
  /// Called before the first run for each cause to repeat runs that have a record, with their ids.
  std::function<void(const std::string& cause, const std::vector<std::string>& ids)> repeated = {};
  /// Called for each chosen run whose result stays.
  std::function<void(const RunRecord&)> kept = {};
};

/// What a batch does before workers run its plan, and after. Both arguments must outlive it.
class Executor {
 public:
  Executor(const std::vector<PlannedRun>& plan, const ExecutorOptions& options)
      : plan_(plan), options_(options) {}

  /// Gives each run that is to come a record that says not_run and its scenario, and writes
  /// plan.json with these runs in the order of runOrder(). Throws InputError for what is in the
  /// way.
  void announce();
  /// Goes on with a plan that was announced by another process. Throws InputError where there is
  /// none.
  void join();
  /// Ids of what announce() or join() found to run.
  const std::vector<std::string>& queue() const { return queue_; }
  /// Of a run that has a result now.
  void take(const RunRecord& record) { ended_[record.id] = record; }
  /// Record of every planned run, in their order: those taken, else what their files say.
  std::vector<RunRecord> collect();
  /// Removes plan.json and the leases that were left behind: no worker is to come.
  void close() const;

 private:
  void refuseRenamed() const;
  void enqueue(std::size_t index);
  void orderQueue(std::deque<std::size_t>& queue) const;
  bool isChosen(std::size_t index) const;
  bool staysOrIsCounted(std::size_t index);
  void informCaller() const;
  void writeRecords() const;
  void writeRecord(std::size_t index) const;
  std::filesystem::path folderOf(std::size_t index) const;

  const std::vector<PlannedRun>& plan_;
  const ExecutorOptions& options_;
  std::vector<RunRecord> records_;
  std::vector<std::size_t> resumed_;                          ///< runs that were complete already
  std::map<std::string, std::vector<std::string>> repeated_;  ///< ids by cause
  std::deque<std::size_t> now_;
  std::deque<std::size_t> later_;  ///< not chosen
  std::set<std::size_t> stale_;    ///< of these, complete ones whose result does not stand any more
  std::vector<std::string> queue_;
  std::map<std::string, RunRecord> ended_;
};

/// Record of every planned run, in their order, whatever happened to it; see runPlanned. It also
/// waits for runs that other workers have.
std::vector<RunRecord> executeRuns(const std::vector<PlannedRun>& plan,
                                   const ExecutorOptions& options, const std::atomic<bool>& stop);

}  // namespace cdiff::evaluation
