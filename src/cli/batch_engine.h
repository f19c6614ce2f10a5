// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <CLI/CLI.hpp>
#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

#include "cli/progress.h"
#include "evaluation/executor.h"
#include "evaluation/slurm/slurm_options.h"

namespace cdiff::cli {

// The engines that run the plan of a batch: this process, the jobs of a cluster, or none.

/// Where sessions run, as a command line says it.
struct EngineArguments {
  std::string command = "cdiff evaluate";  ///< that is run
  /// How its user goes on with jobs that outlive it; " --results FOLDER" follows.
  std::string go_on = "to follow them again: cdiff evaluate --attach";
  std::string again = "with --resume";  ///< how its user runs what is left
  std::string engine = "local";         ///< local | slurm | print
  std::vector<std::string> slurm;       ///< texts of --slurm
  int jobs = 1;                         ///< sessions at a time; on a cluster in each task
  bool fresh = false;                   ///< the program starts afresh for each session

  bool isLocal() const { return engine == "local"; }
  bool prints() const { return engine == "print"; }
};

/// Adds --jobs, --engine and --slurm.
void addEngineOptions(CLI::App& command, EngineArguments& arguments);

/// Adds --fresh, where each run is a session.
void addFreshOption(CLI::App& command, EngineArguments& arguments);

/// Throws InputError where Slurm is missing or does not answer, or the options are wrong.
void requireEngine(const EngineArguments& arguments);

/// Runs a plan and gives the record of every planned run, in their order. `options` say what is run
/// and what is called when a run ends; the engine sets program, server and jobs. `attach`: the jobs
/// of the plan are on the cluster already. `stop`: once true, no run is started here; jobs on a
/// cluster go on. The engine `print` writes plan and script, prints the script, and runs nothing.
/// Throws InputError where Slurm refuses; nothing is queued then.
std::vector<evaluation::RunRecord> executeOn(const EngineArguments& arguments,
                                             const std::vector<evaluation::PlannedRun>& plan,
                                             evaluation::ExecutorOptions options, bool attach,
                                             BatchProgress& progress,
                                             const std::atomic<bool>& stop);

/// Throws InputError where a worker is at work on a plan that is to be replaced, or a job for it is
/// queued. What a worker of another host holds is watched: it counts as dead after 120 s without a
/// sign.
void requireNoWorker(const std::filesystem::path& results);

/// Ends the jobs of a result folder; what they had under way is returned to the plan.
void cancelEngine(const std::filesystem::path& results);

}  // namespace cdiff::cli
