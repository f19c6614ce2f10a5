// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/session_files.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <vector>

#include "core/clock.h"
#include "core/file.h"
#include "core/markup.h"
#include "core/output_folder.h"
#include "core/program.h"
#include "core/registry.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "metrics/metric_registry.h"
#include "metrics/session_metrics.h"
#include "node_graph/lockstep/node_process.h"
#include "node_graph/messages/topics.h"
#include "node_graph/result_reserve.h"
#include "page/result_writer.h"
#include "planners/planner_by_slot.h"
#include "planners/registry.h"
#include "plugins/plugin_loader.h"
#include "record/result_folder.h"
#include "ros/ros.h"

namespace cdiff::node_graph {
namespace {

/// The process of all nodes, as scripts/session names it.
constexpr const char* kNodeletProcess = "session_nodelets";
/// Holds the process of the roslaunch whose input was refused.
constexpr const char* kRefusedLaunch = "e2e_cdiff_refused_launch";

}  // namespace

void noteRefusal() { ros::param::set(kRefusedLaunch, static_cast<int>(::getppid())); }

bool takeRefusal() {
  int launch = 0;
  if (!ros::param::get(kRefusedLaunch, launch) || launch != ::getppid()) return false;
  ros::param::del(kRefusedLaunch);
  return true;
}

namespace {

namespace fs = std::filesystem;

fs::path ownFolder(const session::ScenarioOptions& options) {
  const char* home = std::getenv("HOME");
  const fs::path base = home != nullptr ? fs::path(home) : core::temporaryFolder();
  return base / "e2e_cdiff_results" /
         (core::fileName(options.name) + "_seed" + std::to_string(options.seed) + "_" +
          core::timeForFileName());
}

/// Whether a file is there that is younger than the launch of this session.
bool writtenByThisLaunch(const fs::path& path) {
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0) return false;
  const double written =
      static_cast<double>(file.st_mtim.tv_sec) + 1e-9 * static_cast<double>(file.st_mtim.tv_nsec);
  return written >= launchTime().value_or(0.0);
}

/// Whether nodes of this launch have begun their files there.
bool begunByThisLaunch(const fs::path& folder) {
  for (const char* name : {"session.yaml", "session.bag", "session.bag.active"}) {
    if (writtenByThisLaunch(folder / name)) return true;
  }
  return false;
}

/// The requested folder; empty when none was requested.
fs::path askedFolder(const Parameters& parameters) {
  const std::string text = parameters.text("results");
  return text.empty() ? fs::path() : fs::absolute(text).lexically_normal();
}

/// The exit code of a session of this launch whose simulator left its ticks to others.
std::optional<int> reservedResult(const fs::path& folder, traffic::SessionStatus status,
                                  const traffic::Fault& fault) {
  if (folder.empty() || !writtenByThisLaunch(folder / ".reserve")) return std::nullopt;
  const std::optional<int> exit_code = writeReservedResult(folder, status, fault);
  if (exit_code) writeExitCode(folder, *exit_code);
  return exit_code;
}

int writeUnstarted(const session::ScenarioOptions& options, const fs::path& folder,
                   traffic::SessionStatus status, const traffic::Fault& fault) {
  const session::SessionSetup setup(options);
  const bool deterministic = options.real_time_factor == 0.0;
  page::ResultWriter writer(setup, {kDeployment, "unknown", deterministic}, folder);
  traffic::TrafficSnapshot snapshot;
  snapshot.status = status;
  snapshot.faults.push_back(
      {fault.tick, fault.source, fault.text + pluginsOf(fault.source, options)});
  session::TickRecord record;
  record.snapshot = &snapshot;
  writer.observe(record);
  writer.finish(0.0);
  std::cout << writer.table() << std::flush;
  return writer.exitCode();
}

}  // namespace

std::string pluginsOf(const std::string& node, const session::ScenarioOptions& options) {
  const bool all = node == kNodeletProcess;
  const bool of_cbvs = all || node == kCbvPlannerNode || node == kDiffusionPlannerNode;
  std::vector<std::string> names;
  if (all || node == kEgoPlannerNode) names = planners::planningMembers(options.ego_planner);
  for (const std::string& name :
       of_cbvs ? planners::planningMembers(options.cbv_planner) : std::vector<std::string>()) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  std::string text;
  for (const std::string& name : names) {
    const std::string source = planners::sourceOf(name);
    if (core::isPlugin(source)) text += "; it calls planner '" + name + "' of " + source;
  }
  if (!all && node != kMetricsNode) return text;
  for (const metrics::MetricDescriptor& metric : metrics::metricDescriptors()) {
    if (core::isPlugin(metric.source))
      text += "; it calls metric '" + metric.name + "' of " + metric.source;
  }
  return text;
}

void leaveOutPluginMetrics() {
  for (const metrics::MetricDescriptor& metric : metrics::metricDescriptors()) {
    if (!core::isPlugin(metric.source)) continue;
    metrics::leaveOutMetric(metric.name, "metric '" + metric.name + "' of " + metric.source +
                                             " is left out: the metrics node did not finish");
  }
}

fs::path resultFolder(const std::string& given, const session::ScenarioOptions& options) {
  return fs::absolute(given.empty() ? ownFolder(options) : fs::path(given)).lexically_normal();
}

void enterFolder(const std::string& folder) {
  std::error_code error;
  if (!folder.empty()) fs::current_path(folder, error);
  if (error) throw core::InputError("parameter ~folder is '" + folder + "': " + error.message());
}

int writeUnstartedResult(const Parameters& parameters, traffic::SessionStatus status,
                         const traffic::Fault& fault) {
  fs::path folder;
  try {
    plugins::loadPlugins();  // the scenario may have their keys
    leaveOutPluginMetrics();
    enterFolder(parameters.text("folder"));
    folder = askedFolder(parameters);
    const bool replaces = status == traffic::SessionStatus::kInterrupted;
    if (!folder.empty() && !replaces && writtenByThisLaunch(folder / "exit_code"))
      return core::ExitCode::kRunTimeError;
    if (const auto exit_code = reservedResult(folder, status, fault)) return *exit_code;
    requireHeededLaunchArguments();  // else it would be the result of another session than was
                                     // meant
    const auto options = requestedScenario(parameters);
    folder = resultFolder(parameters.text("results"), options);
    const bool overwrite = parameters.flag("overwrite", false) || begunByThisLaunch(folder);
    const record::ResultFolder claimed(folder, kDeployment, overwrite);
    const int exit_code = writeUnstarted(options, folder, status, fault);
    writeExitCode(folder, exit_code);
    return exit_code;
  } catch (const core::InputError& error) {
    std::cerr << core::plainText(error.what()) << std::endl;
    writeRefusal(folder);
    return core::ExitCode::kBadInput;
  }
}

void writeExitCode(const fs::path& folder, int exit_code) {
  const std::string text = std::to_string(exit_code) + "\n";
  const char* also = std::getenv(kExitCodeVariable);
  if (also != nullptr && *also != '\0') core::writeFileAtomically(also, text);
  if (!folder.empty()) core::writeOwnFile(folder / "exit_code", text);
}

void writeRefusal(const fs::path& folder, int exit_code) {
  writeExitCode({}, exit_code);
  if (folder.empty()) return;
  try {
    record::requireFreeFolder(folder, false);
    const core::FolderLock lock(folder, kDeployment);
    writeExitCode(folder, exit_code);
  } catch (const core::InputError&) {
    // Another session's folder, or none can be made: what is wrong is printed in any case.
  }
}

}  // namespace cdiff::node_graph
