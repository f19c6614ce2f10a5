// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

#include "evaluation/remaining_time.h"
#include "evaluation/run_record.h"
#include "session/session_observer.h"

namespace cdiff::cli {

/// Progress of a session on standard error, for `cdiff run`: simulated time, pace (x real time),
/// and the wall time left at most. On a terminal it rewrites one line every 0.2 s; elsewhere it
/// prints a line every 10 s of wall time.
class Progress : public session::SessionObserver {
 public:
  /// `time_limit`: the longest that the protocol allows, in simulated time [s]; `grows`: with the
  /// ego's progress, so that a session can time out before.
  Progress(double time_limit, bool grows);
  void observe(const session::TickRecord& record) override;

 private:
  double time_limit_;
  bool grows_;
  bool terminal_;
  std::chrono::steady_clock::time_point begin_;
  std::chrono::steady_clock::time_point last_;
};

/// Progress of a batch on standard error: runs done and broken, wall time left; where the runs are
/// sessions also failed verdicts, pace (x real time), and of each its verdict, and whether it had
/// no CBV. On a terminal it rewrites one line; elsewhere it prints a line per run.
class BatchProgress {
 public:
  /// Of runs that are to be run, `jobs` at a time.
  BatchProgress(const std::vector<evaluation::PlannedRun>& runs, int jobs);
  /// Prints one line about the runs that a resumed batch must repeat for the same cause.
  void repeated(const std::string& cause, const std::vector<std::string>& ids) const;
  /// A run has ended; `resumed`: it was complete before this batch started.
  void ended(const evaluation::RunRecord& record, bool resumed);
  /// Ends the rewritten line and prints the share of start-up. Call it once, after the last run.
  void finish() const;

 private:
  /// What the runs say of themselves, where they are sessions; ends with ", ".
  std::string sessionsText(double wall) const;

  std::size_t total_;
  bool sessions_;  ///< what runs
  evaluation::RemainingTime remaining_;
  bool terminal_;
  std::chrono::steady_clock::time_point begin_;
  std::size_t done_ = 0;
  std::size_t resumed_ = 0;
  std::size_t broken_ = 0;
  std::size_t failed_ = 0;  ///< verdicts
  double simulated_ = 0.0;  ///< simulated time of all runs together [s]
  double wall_ = 0.0;       ///< wall time of all complete runs together [s]
  double start_up_ = 0.0;   ///< of it, before their sessions: program, network, weights [s]
};

}  // namespace cdiff::cli
