// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "cli/batch_engine.h"

#include <iostream>

#include "core/file.h"
#include "core/output_folder.h"
#include "core/program.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/slurm/slurm_progress.h"
#include "evaluation/slurm/slurm_queue.h"
#include "evaluation/slurm/slurm_script.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;

/// The name is made of the folder and the plan, so that a second batch has another one.
evaluation::SlurmBatch batchOf(const evaluation::Executor& executor, const fs::path& results,
                               int jobs) {
  constexpr std::size_t kDigits = 12;
  evaluation::SlurmBatch batch;
  batch.results = results;
  batch.program = fs::read_symlink("/proc/self/exe");
  batch.runs = executor.queue().size();
  batch.jobs = jobs;
  batch.name =
      "cdiff-" +
      core::sha256(results.string() + core::joinText(executor.queue(), "\n")).substr(0, kDigits);
  return batch;
}

void writeScript(const evaluation::SlurmBatch& batch, const evaluation::SlurmOptions& options) {
  core::OutputFolder folder(core::OutputFolder(batch.results).subfolder("slurm"));
  folder.write("job.sh", evaluation::slurmScript(batch, options));
}

/// Ends the jobs of a batch whose submission failed. Throws an error that names them where Slurm
/// does not.
void cancelAfter(const std::string& name, const core::InputError& error) {
  try {
    evaluation::cancelJobs(name);
  } catch (const core::InputError& other) {
    throw core::InputError(std::string(error.what()) + "; jobs of the name " + name +
                           " are queued and could not be ended (" + other.what() +
                           "): end them with --cancel");
  }
}

std::string goOnText(const fs::path& results) {
  const std::string command = "cdiff evaluate --results " + results.string();
  return "to follow them again: " + command + " --attach\nto end them: " + command + " --cancel\n";
}

}  // namespace

void requireEngine(const std::string& engine, const evaluation::SlurmOptions& options) {
  options.validate();
  if (engine == "slurm") evaluation::requireSlurm();
}

void printJobs(const evaluation::Executor& executor, const fs::path& results, int jobs,
               const evaluation::SlurmOptions& options) {
  const evaluation::SlurmBatch batch = batchOf(executor, results, jobs);
  writeScript(batch, options);
  std::cout << evaluation::slurmScript(batch, options);
  for (const auto& arguments : evaluation::sbatchArguments(batch, options)) {
    std::cout << "sbatch";
    for (const std::string& argument : arguments)
      std::cout << " " << evaluation::shellWord(argument);
    std::cout << "\n";
  }
}

void submitJobs(const evaluation::Executor& executor, const fs::path& results, int jobs,
                const evaluation::SlurmOptions& options) {
  if (executor.queue().empty()) return;
  evaluation::SlurmBatch batch = batchOf(executor, results, jobs);
  batch.largest_array = evaluation::requireSlurm();
  writeScript(batch, options);
  evaluation::writeJobName(results, batch.name, {});  // --cancel finds the jobs from the first on
  std::vector<std::string> ids;
  try {
    for (const auto& arguments : evaluation::sbatchArguments(batch, options))
      ids.push_back(evaluation::submitJob(arguments));
  } catch (const core::InputError& error) {
    if (!ids.empty()) cancelAfter(batch.name, error);
    throw core::InputError(std::string(error.what()) +
                           "; nothing is queued: go on with --resume when that is mended");
  }
  evaluation::writeJobName(results, batch.name, ids);
  std::cerr << "submitted " << core::joinText(ids, ", ") << " as " << batch.name << "\n"
            << goOnText(results);
}

bool followJobs(const std::vector<std::string>& ids, const fs::path& results,
                const evaluation::SlurmOptions& options, BatchProgress& progress) {
  if (ids.empty()) return true;
  evaluation::SlurmWait wait;
  wait.results = results;
  wait.job_name = evaluation::readJobName(results);
  wait.poll = options.poll;
  wait.ended = [&](const evaluation::RunRecord& record) { progress.ended(record, false); };
  wait.unanswered = [] { std::cerr << "Slurm does not answer; waiting for it\n"; };
  const auto open = evaluation::waitForJobs(ids, wait, core::catchStopSignals());
  if (core::stopRequested()) {
    std::cerr << "the jobs go on without this command\n" << goOnText(results);
    return false;
  }
  if (!open.empty()) {
    std::cerr << open.size() << (open.size() == 1 ? " run was" : " runs were")
              << " not run: their jobs ended before, see "
              << evaluation::slurmFolder(results).string() << "; go on with --resume\n";
  }
  return true;
}

}  // namespace cdiff::cli
