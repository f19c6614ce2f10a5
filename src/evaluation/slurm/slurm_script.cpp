// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/slurm/slurm_script.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::evaluation {
namespace {

/// What a session reads of the environment, besides what a login sets.
constexpr const char* kVariables[] = {
    "E2E_CDIFF_ISA",    "E2E_CDIFF_SHARE",    "E2E_CDIFF_CACHE",
    "ROS_PACKAGE_PATH", "ONEDNN_MAX_CPU_ISA", "SUMO_HOME",
    "LD_LIBRARY_PATH",  "CMAKE_PREFIX_PATH",  "E2E_CDIFF_PLUGINS"};
/// Time between the signal and the end of a task [s].
constexpr int kNotice = 60;

/// The logs of the tasks, by job and task. Throws InputError for a folder with a backslash, with
/// which Slurm replaces nothing.
std::string logPattern(const std::filesystem::path& folder) {
  std::string pattern;
  for (const char sign : folder.string()) pattern += sign == '%' ? "%%" : std::string(1, sign);
  if (pattern.find('\\') != std::string::npos)
    throw core::InputError("'" + folder.string() +
                           "' has a backslash, with which Slurm names no logs; give another "
                           "--results");
  return pattern + "/%A_%a.log";
}

std::size_t taskCount(const SlurmBatch& batch, const SlurmOptions& options) {
  const auto each = static_cast<std::size_t>(options.runs_per_task);
  return std::max<std::size_t>(1, (batch.runs + each - 1) / each);
}

}  // namespace

std::filesystem::path slurmFolder(const std::filesystem::path& results) {
  return results / "slurm";
}

std::string shellWord(const std::string& text) {
  std::string word = "'";
  for (const char sign : text) word += sign == '\'' ? std::string("'\\''") : std::string(1, sign);
  return word + "'";
}

std::string slurmScript(const SlurmBatch& batch, const SlurmOptions& options) {
  std::string text = "#!/bin/bash\n# Works on its part of a batch of cdiff.\n";
  for (const char* name : kVariables) {
    const char* value = std::getenv(name);
    if (value != nullptr) text += std::string("export ") + name + "=" + shellWord(value) + "\n";
  }
  text += "export OMP_NUM_THREADS=1\n";
  for (const std::string& line : options.setup) text += line + "\n";
  return text + "exec " + shellWord(batch.program.string()) + " worker " +
         shellWord(batch.results.string()) + " --wait --jobs " + std::to_string(batch.jobs) +
         " --part $(($1 + SLURM_ARRAY_TASK_ID))/" + std::to_string(taskCount(batch, options)) +
         "\n";
}

std::vector<std::vector<std::string>> sbatchArguments(const SlurmBatch& batch,
                                                      const SlurmOptions& options) {
  const std::filesystem::path folder = slurmFolder(batch.results);
  std::vector<std::string> common = {"--parsable",
                                     "--job-name=" + batch.name,
                                     "--output=" + logPattern(folder),
                                     "--open-mode=append",
                                     "--requeue",
                                     "--signal=B:TERM@" + std::to_string(kNotice),
                                     "--export=NONE",
                                     "--cpus-per-task=" + std::to_string(batch.jobs)};
  const std::pair<const char*, std::string> texts[] = {{"partition", options.partition},
                                                       {"account", options.account},
                                                       {"qos", options.qos},
                                                       {"time", options.time},
                                                       {"mem", options.memory},
                                                       {"constraint", options.constraint}};
  for (const auto& [key, value] : texts) {
    if (!value.empty()) common.push_back(std::string("--") + key + "=" + value);
  }
  if (options.nice > 0) common.push_back("--nice=" + std::to_string(options.nice));
  common.insert(common.end(), options.extra_args.begin(), options.extra_args.end());
  const std::size_t tasks = taskCount(batch, options);
  std::vector<std::vector<std::string>> arrays;
  for (std::size_t first = 0; first < tasks; first += batch.largest_array) {
    const std::size_t last = std::min(tasks - first, batch.largest_array) - 1;
    std::vector<std::string> arguments = common;
    const std::string limit =
        options.max_running > 0 ? "%" + std::to_string(options.max_running) : "";
    arguments.push_back("--array=0-" + std::to_string(last) + limit);
    arguments.push_back((folder / "job.sh").string());
    arguments.push_back(std::to_string(first));
    arrays.push_back(std::move(arguments));
  }
  return arrays;
}

}  // namespace cdiff::evaluation
