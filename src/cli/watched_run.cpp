// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "cli/watched_run.h"

#include <chrono>
#include <exception>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "core/folder_lock.h"
#include "core/forked_work.h"
#include "core/program.h"
#include "core/text.h"
#include "metrics/metric_registry.h"
#include "node_graph/result_reserve.h"
#include "planners/registry.h"
#include "plugins/plugin_loader.h"
#include "record/result_folder.h"

namespace cdiff::cli {
namespace {

using Clock = std::chrono::steady_clock;

/// Kind of the calls to SUMO.
constexpr const char* kSimulatorCall = "simulator";

/// The exit code of the session; errors are said as the main function says them.
int guarded(const std::function<int()>& session) {
  try {
    return session();
  } catch (const std::exception& error) {
    const core::Failure failure = core::failureOf(error);
    std::cerr << "cdiff: " << failure.text << "\n";
    return failure.exit_code;
  }
}

std::string sourceOf(const core::WorkEnd& end) {
  if (end.kind == "planner") return planners::sourceOf(end.name);
  for (const metrics::MetricDescriptor& metric : metrics::metricDescriptors()) {
    if (metric.name == end.name) return metric.source;
  }
  return "";
}

/// What ended the session, or what may have done so where that is not known.
std::string faultText(const core::WorkEnd& end) {
  if (end.kind == kSimulatorCall && end.name == "libsumo")
    return "SUMO ended the session, in whose process it ran: " + end.how;
  if (end.kind == kSimulatorCall) {
    return "SUMO ended the session by an answer that " + end.name + " cannot read: " + end.how +
           "; check the program sumo";
  }
  if (!end.kind.empty()) {
    return end.kind + " '" + end.name + "' of " + sourceOf(end) + " ended the session: " + end.how +
           "; its author must mend it";
  }
  std::vector<std::string> files;
  for (const plugins::LoadedPlugin& plugin : plugins::loadPlugins())
    files.push_back("'" + plugin.library.file.string() + "'");
  const std::string text =
      (end.stage == core::WorkStage::kResultWritten ? "the program ended after"
                                                    : "the session ended before") +
      std::string(" its result was written: ") + end.how;
  return files.empty() ? text : text + "; it had loaded the plug-in " + core::joinText(files, ", ");
}

/// Who is to blame in the result's list of faults.
std::string sourceName(const core::WorkEnd& end) {
  if (end.kind == kSimulatorCall) return end.kind;
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
      core::runForked([&] { return guarded(session); }, run.answer_timeout, run.stop);
  if (end.exit_code) return *end.exit_code;
  node_graph::AbandonedSession abandoned;
  if (end.interrupted) abandoned.status = traffic::SessionStatus::kInterrupted;
  abandoned.source = sourceName(end);
  abandoned.text = faultText(end);
  abandoned.wall_seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  std::cerr << "cdiff: " << abandoned.text << "\n";
  if (end.kind == "metric") metrics::leaveOutMetric(end.name, abandoned.text);
  if (end.stage != core::WorkStage::kResultWritten) writeResult(run, abandoned, end.stage);
  return end.interrupted ? core::ExitCode::kInterrupted : core::ExitCode::kRunTimeError;
}

}  // namespace cdiff::cli
