// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "cli/plugin_guard.h"

#include <sys/resource.h>

#include <atomic>
#include <iostream>
#include <vector>

#include "core/markup.h"
#include "core/program.h"
#include "core/registry.h"
#include "core/text.h"
#include "guidance/objective_registry.h"
#include "metrics/metric_registry.h"
#include "planners/registry.h"
#include "plugins/plugin_loader.h"

namespace cdiff::cli {
namespace {

constexpr double kAnswerPatience = 600.0;  // [s] for a call of a plug-in, which may load a network

std::string sourceOf(const core::WorkEnd& end) {
  if (end.kind == "planner") return planners::sourceOf(end.name);
  for (const metrics::MetricDescriptor& metric : metrics::metricDescriptors()) {
    if (end.kind == "metric" && metric.name == end.name) return metric.source;
  }
  return guidance::objectiveSource(end.name);
}

std::string simulatorText(const core::WorkEnd& end, const std::string& ended) {
  if (end.name == "libsumo") return "SUMO ended " + ended + ", in whose process it ran: " + end.how;
  return "SUMO ended " + ended + " by an answer that " + end.name + " cannot read: " + end.how +
         "; check the program sumo";
}

/// The plug-ins that may have done what nobody names.
std::string loadedText() {
  std::vector<std::string> files;
  for (const plugins::LoadedPlugin& plugin : plugins::loadPlugins())
    files.push_back("'" + plugin.library.file.string() + "'");
  return files.empty() ? "" : "; it had loaded the plug-in " + core::joinText(files, ", ");
}

/// Libraries of others crash where memory runs out; empty where no limit is set.
std::string limitText() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return "";
  return "; `ulimit -v` is " + std::to_string(limit.rlim_cur / 1024) + " and may be why";
}

}  // namespace

std::string endText(const core::WorkEnd& end, const std::string& ended) {
  if (end.kind == core::kSimulatorCall) return simulatorText(end, ended);
  if (!end.kind.empty()) {
    const std::string source = sourceOf(end);
    return end.kind + " '" + end.name + "' of " + source + " ended " + ended + ": " + end.how +
           (core::isPlugin(source) ? "; its author must mend it" : loadedText() + limitText());
  }
  const std::string text = end.stage == core::WorkStage::kResultWritten
                               ? "the program ended after its result was written: " + end.how
                               : ended + " ended before its work was done: " + end.how;
  return end.from_outside ? text : text + loadedText();
}

int runBesidePlugins(const std::function<int()>& command) {
  if (core::threadCount() > 1) return command();  // of a plug-in; a copy would not have them
  const std::atomic<bool>& stop = core::catchStopSignals();
  const core::WorkEnd end = core::runForked(
      [&] {
        core::prepareProgram();  // the copy ends at a stop signal until its command takes them
        return core::stopRequested() ? core::ExitCode::kInterrupted : core::reportFailure(command);
      },
      kAnswerPatience, stop);
  if (end.exit_code) return *end.exit_code;
  if (!end.interrupted || !end.kind.empty())
    std::cerr << "cdiff: " << core::plainText(endText(end, "the program")) << "\n";
  return end.interrupted ? core::ExitCode::kInterrupted : core::ExitCode::kRunTimeError;
}

}  // namespace cdiff::cli
