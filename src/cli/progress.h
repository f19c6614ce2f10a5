// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A line on the terminal that tells how far a session is: simulated time, pace, time left.
#pragma once

#include <chrono>

#include "session/session_observer.h"

namespace cdiff::cli {

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

}  // namespace cdiff::cli
