// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "cli/progress.h"

#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <optional>

#include "core/text.h"
#include "metrics/known_measures.h"

namespace cdiff::cli {
namespace {

/// Of a session that has ended: its verdict, and whether it had no CBV.
std::string verdictText(const evaluation::RunRecord& record) {
  const auto cbvs = record.measures.find(metrics::known::kCbvCount.name);
  const bool none = cbvs != record.measures.end() && cbvs->second == 0.0;
  return (record.complete() ? ", " + record::wordOf(record.verdict) : "") +
         (none ? ", no CBV" : "");
}

double secondsBetween(std::chrono::steady_clock::time_point begin,
                      std::chrono::steady_clock::time_point end) {
  return std::chrono::duration<double>(end - begin).count();
}

}  // namespace

Progress::Progress(double time_limit, bool grows)
    : time_limit_(time_limit),
      grows_(grows),
      terminal_(::isatty(STDERR_FILENO) == 1),
      begin_(std::chrono::steady_clock::now()),
      last_(begin_) {}

void Progress::observe(const session::TickRecord& record) {
  const traffic::TrafficSnapshot& snapshot = *record.snapshot;
  const bool ended = snapshot.status != traffic::SessionStatus::kRunning;
  const std::chrono::steady_clock::time_point now = std::chrono::steady_clock::now();
  const double interval = terminal_ ? 0.2 : 10.0;
  if (!ended && secondsBetween(last_, now) < interval) return;
  last_ = now;
  const double wall = secondsBetween(begin_, now);
  const double factor = wall > 0.0 ? snapshot.time / wall : 0.0;
  const double left = factor > 0.0 ? (time_limit_ - snapshot.time) / factor : 0.0;
  const std::string limit =
      (grows_ ? " s of at most " : " s of ") + core::formatFixed(time_limit_, 0);
  std::cerr << (terminal_ ? "\r" : "") << core::formatFixed(snapshot.time, 1)
            << (ended ? "" : limit) << " s simulated, " << core::formatFixed(factor, 1)
            << " x real time, ";
  if (ended)
    std::cerr << traffic::toText(snapshot.status) << std::string(24, ' ') << "\n";
  else
    std::cerr << "at most " << core::formatFixed(left, 0) << " s left   "
              << (terminal_ ? "" : "\n");
  std::cerr.flush();
}

BatchProgress::BatchProgress(const std::vector<evaluation::PlannedRun>& runs, int jobs)
    : total_(runs.size()),
      sessions_(runs.empty() || runs.front().command.isSession()),
      remaining_(runs, jobs),
      terminal_(::isatty(STDERR_FILENO) == 1),
      begin_(std::chrono::steady_clock::now()) {}

void BatchProgress::repeated(const std::string& cause, const std::vector<std::string>& ids) const {
  constexpr std::size_t kShown = 5;
  const std::vector<std::string> shown(ids.begin(), ids.begin() + std::min(kShown, ids.size()));
  std::cerr << ids.size() << (ids.size() == 1 ? " run" : " runs") << " to do: " << cause << ": "
            << core::joinText(shown, ", ");
  if (ids.size() > kShown) std::cerr << " and " << ids.size() - kShown << " more";
  std::cerr << "\n";
}

std::string BatchProgress::sessionsText(double wall) const {
  return std::to_string(failed_) + (failed_ == 1 ? " verdict" : " verdicts") + " failed, " +
         core::formatFixed(wall > 0.0 ? simulated_ / wall : 0.0, 1) + " x real time, ";
}

void BatchProgress::ended(const evaluation::RunRecord& record, bool resumed) {
  ++done_;
  remaining_.ended(record.id, resumed ? std::nullopt : std::make_optional(record.wall_seconds));
  if (resumed) {
    ++resumed_;
    return;
  }
  broken_ += record.failed();
  failed_ += record.has(record::Outcome::kFailed);
  simulated_ += record.simulated_seconds;
  const auto factor = record.measures.find("real_time_factor");
  if (record.complete() && factor != record.measures.end() && factor->second > 0.0) {
    wall_ += record.wall_seconds;
    start_up_ += record.wall_seconds - record.simulated_seconds / factor->second;
  }
  const double wall =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  std::cerr << (terminal_ ? "\r\033[K" : "") << done_ << "/" << total_ << " done, " << broken_
            << " broken, " << (sessions_ ? sessionsText(wall) : "")
            << core::formatFixed(remaining_.left(wall), 0) << " s left: " << record.id << " "
            << record.status << (sessions_ ? verdictText(record) : "")
            << (record.cause.empty() ? "" : " (" + record.cause + ")")
            << (terminal_ && !record.failed() ? "" : "\n");
  std::cerr.flush();
}

void BatchProgress::finish() const {
  if (terminal_ && done_ > resumed_) std::cerr << "\n";
  if (wall_ > 0.0) {
    std::cerr << "start-up (program, network, weights) took "
              << core::formatFixed(100.0 * start_up_ / wall_, 0)
              << " % of the sessions' wall time\n";
  }
  if (resumed_ > 0) std::cerr << resumed_ << " runs were complete already\n";
}

}  // namespace cdiff::cli
