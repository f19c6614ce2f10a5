// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

#include "evaluation/run_record.h"
#include "session/session_observer.h"

namespace cdiff::cli {

/// A line on the terminal with the progress of a session: simulated time, pace, time left.
/// Rewrites one line on a terminal; prints a plain line every 10 s of wall time elsewhere.
class Progress : public session::SessionObserver {
 public:
  /// `time_limit` of the protocol [s].
  explicit Progress(double time_limit);
  void observe(const session::TickRecord& record) override;

 private:
  double time_limit_;
  bool terminal_;
  std::chrono::steady_clock::time_point begin_;
  std::chrono::steady_clock::time_point last_;
};

/// How far a batch is: done of total, failed, pace, time left. One line that is rewritten on a
/// terminal, a plain line per run elsewhere.
class BatchProgress {
 public:
  explicit BatchProgress(std::size_t total);
  /// Runs that a resumed batch runs again, or for the first time, for one cause: one line.
  void repeated(const std::string& cause, const std::vector<std::string>& ids) const;
  /// A run ended; `resumed`: it had before.
  void ended(const evaluation::RunRecord& record, bool resumed);
  /// Leaves the terminal on a line of its own.
  void finish() const;

 private:
  std::size_t total_;
  bool terminal_;
  std::chrono::steady_clock::time_point begin_;
  std::size_t done_ = 0;
  std::size_t resumed_ = 0;
  std::size_t failed_ = 0;
  double simulated_ = 0.0;  ///< by all runs together [s]
};

}  // namespace cdiff::cli
