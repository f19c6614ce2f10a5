// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "cli/progress.h"

#include <unistd.h>

#include <iostream>

#include "core/text.h"

namespace cdiff::cli {
namespace {

using Clock = std::chrono::steady_clock;

double secondsBetween(Clock::time_point begin, Clock::time_point end) {
  return std::chrono::duration<double>(end - begin).count();
}

}  // namespace

Progress::Progress(double time_limit)
    : time_limit_(time_limit),
      terminal_(::isatty(STDERR_FILENO) == 1),
      begin_(Clock::now()),
      last_(begin_) {}

void Progress::observe(const session::TickRecord& record) {
  const traffic::TrafficSnapshot& snapshot = *record.snapshot;
  const bool ended = snapshot.status != traffic::SessionStatus::kRunning;
  const Clock::time_point now = Clock::now();
  const double interval = terminal_ ? 0.2 : 10.0;
  if (!ended && secondsBetween(last_, now) < interval) return;
  last_ = now;
  const double wall = secondsBetween(begin_, now);
  const double factor = wall > 0.0 ? snapshot.time / wall : 0.0;
  const double left = factor > 0.0 ? (time_limit_ - snapshot.time) / factor : 0.0;
  std::cerr << (terminal_ ? "\r" : "") << core::formatFixed(snapshot.time, 1) << " s of "
            << core::formatFixed(time_limit_, 0) << " s simulated, " << core::formatFixed(factor, 1)
            << " x real time, ";
  if (ended)
    std::cerr << traffic::toText(snapshot.status) << "          \n";
  else
    std::cerr << "at most " << core::formatFixed(left, 0) << " s left   "
              << (terminal_ ? "" : "\n");
  std::cerr.flush();
}

}  // namespace cdiff::cli
