// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "cli/watched_run.h"

#include <chrono>
#include <iostream>
#include <memory>
#include <string>

#include "cli/plugin_guard.h"
#include "core/folder_lock.h"
#include "core/forked_work.h"
#include "core/markup.h"
#include "core/program.h"
#include "metrics/metric_registry.h"
#include "node_graph/result_reserve.h"
#include "record/result_folder.h"

namespace cdiff::cli {
namespace {

using Clock = std::chrono::steady_clock;

/// Who is to blame in the result's list of faults.
std::string sourceName(const core::WorkEnd& end) {
  if (end.kind == core::kSimulatorCall) return end.kind;
  return end.kind.empty() ? "cdiff run" : end.kind + ":" + end.name;
}

/// Locks the folder that the copy had taken, or takes it.
void writeResult(const WatchedRun& run, const node_graph::AbandonedSession& session,
                 core::WorkStage stage) {
  std::unique_ptr<core::FolderLock> lock;
  std::unique_ptr<record::ResultFolder> folder;
  if (stage == core::WorkStage::kFolderTaken) {
    lock = std::make_unique<core::FolderLock>(run.folder, "cdiff run");
  } else {
    folder = std::make_unique<record::ResultFolder>(run.folder, "cdiff run", run.overwrite);
  }
  const std::string table = node_graph::writeAbandonedResult(run.setup, run.folder, session);
  if (!run.quiet) std::cout << table << std::flush;
}

}  // namespace

int runWatched(const WatchedRun& run, const std::function<int()>& session) {
  const Clock::time_point begin = Clock::now();
  const core::WorkEnd end =
      core::runForked([&] { return core::reportFailure(session); }, run.answer_timeout, run.stop);
  if (end.exit_code) return *end.exit_code;
  node_graph::AbandonedSession abandoned;
  if (end.interrupted) abandoned.status = traffic::SessionStatus::kInterrupted;
  abandoned.source = sourceName(end);
  abandoned.text = endText(end, "the session");
  abandoned.wall_seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  std::cerr << "cdiff: " << core::plainText(abandoned.text) << "\n";
  if (end.kind == "metric") metrics::leaveOutMetric(end.name, abandoned.text);
  if (end.stage != core::WorkStage::kResultWritten) writeResult(run, abandoned, end.stage);
  return end.interrupted ? core::ExitCode::kInterrupted : core::ExitCode::kRunTimeError;
}

}  // namespace cdiff::cli
