// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "cli/batch_engine.h"

#include <atomic>
#include <chrono>
#include <iostream>
#include <thread>

#include "core/file.h"
#include "core/guarded_process.h"
#include "core/lease.h"
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

/// Ends the jobs of a batch whose submission failed, if there are any. Throws an error that names
/// them where Slurm does not.
void cancelAfter(const std::string& name, const core::InputError& error) {
  try {
    evaluation::cancelJobs(name);
  } catch (const core::InputError& other) {
    throw core::InputError(std::string(error.what()) + "; jobs of the name " + name +
                           " may be queued and could not be ended (" + other.what() +
                           "): end them with --cancel");
  }
}

std::string goOnText(const EngineArguments& arguments, const fs::path& results) {
  const std::string end = " --results " + evaluation::shellWord(results.string()) + "\n";
  return arguments.go_on + end + "to end them: " + arguments.command + " --cancel" + end;
}

/// Writes the script of the jobs, prints it and the commands that would submit it.
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

/// Writes the script and submits it, all or nothing. Throws InputError where Slurm refuses.
void submitJobs(const evaluation::Executor& executor, const fs::path& results,
                const EngineArguments& arguments) {
  if (executor.queue().empty()) return;
  const auto options = evaluation::slurmOptionsOf(arguments.slurm);
  evaluation::SlurmBatch batch = batchOf(executor, results, arguments.jobs);
  batch.largest_array = evaluation::requireSlurm();
  writeScript(batch, options);
  evaluation::writeJobName(results, batch.name, {});  // --cancel finds the jobs from the first on
  std::vector<std::string> ids;
  try {
    for (const auto& arguments : evaluation::sbatchArguments(batch, options))
      ids.push_back(evaluation::submitJob(arguments));
  } catch (const core::InputError& error) {
    cancelAfter(batch.name, error);  // also one that was taken, and answered too late
    throw core::InputError(std::string(error.what()) + "; nothing is queued: go on " +
                           arguments.again + " when that is mended");
  }
  evaluation::writeJobName(results, batch.name, ids);
  std::cerr << "submitted " << core::joinText(ids, ", ") << " as " << batch.name << "\n"
            << goOnText(arguments, results);
}

/// Waits for the jobs of a batch whose plan lists these runs; says what goes on, also after a stop
/// signal. Gives whether no job is left that works on the plan.
bool followJobs(const std::vector<std::string>& ids, const fs::path& results,
                const EngineArguments& arguments, BatchProgress& progress,
                const std::atomic<bool>& stop) {
  if (ids.empty()) return true;
  evaluation::SlurmWait wait;
  wait.results = results;
  wait.job_name = evaluation::readJobName(results);
  wait.poll = evaluation::slurmOptionsOf(arguments.slurm).poll;
  wait.ended = [&](const evaluation::RunRecord& record) { progress.ended(record, false); };
  wait.unanswered = [] { std::cerr << "Slurm does not answer; waiting for it\n"; };
  const auto open = evaluation::waitForJobs(ids, wait, stop);
  if (stop) {
    std::cerr << "the jobs go on without this command\n" << goOnText(arguments, results);
    return false;
  }
  if (!open.empty()) {
    std::cerr << open.size() << (open.size() == 1 ? " run was" : " runs were")
              << " not run: their jobs ended before, see "
              << evaluation::slurmFolder(results).string() << "; go on " << arguments.again << "\n";
  }
  return true;
}

/// Between two looks at the leases of another host.
constexpr std::chrono::milliseconds kLeaseLook{200};

/// Throws InputError where jobs of the folder are queued or running, or may be.
void requireNoJobs(const fs::path& results) {
  if (!evaluation::hasJobName(results)) return;
  const std::string name = evaluation::readJobName(results);
  if (!core::programInPath("squeue")) {
    std::cerr << "squeue is not here: whether jobs of the name " << name
              << " are queued is not known\n";
    return;
  }
  const auto tasks = evaluation::queuedTasks(name);
  if (tasks && *tasks == 0) return;
  throw core::InputError(
      "'" + results.string() + "': " +
      (tasks ? "tasks of the name " + name + " wait or run on the cluster (" +
                   std::to_string(*tasks) + ")"
             : "Slurm does not say whether tasks of the name " + name + " wait or run") +
      "; wait until they have ended, or end them (--cancel)");
}

/// Throws InputError where the holder of a lease gives signs of life.
void requireSilent(const fs::path& results, const std::string& id,
                   const core::LeaseHolder& holder) {
  if (!holder.is_alive) return;
  throw core::InputError("run '" + id + "' in '" + results.string() + "' is under way by " +
                         holder.text + "; wait until it has ended, or end it" +
                         (evaluation::hasJobName(results) ? " (--cancel)" : ""));
}

/// On another engine than this process. A stop that comes while jobs are submitted takes effect
/// once all are: between two arrays it would leave jobs that nobody knows.
std::vector<evaluation::RunRecord> executeElsewhere(const EngineArguments& arguments,
                                                    const std::vector<evaluation::PlannedRun>& plan,
                                                    const evaluation::ExecutorOptions& options,
                                                    bool attach, BatchProgress& progress,
                                                    const std::atomic<bool>& stop) {
  evaluation::Executor executor(plan, options);
  if (attach) {
    executor.join();
  } else {
    executor.announce();
    if (arguments.prints() && !executor.queue().empty()) {
      printJobs(executor, options.results, arguments.jobs,
                evaluation::slurmOptionsOf(arguments.slurm));
      return executor.collect();
    }
    if (stop) return executor.collect();
    submitJobs(executor, options.results, arguments);
  }
  if (followJobs(executor.queue(), options.results, arguments, progress, stop)) executor.close();
  return executor.collect();
}

}  // namespace

void addEngineOptions(CLI::App& command, EngineArguments& arguments) {
  command.add_option("--jobs", arguments.jobs, "Sessions at a time")
      ->capture_default_str()
      ->check(CLI::Range(1, 64));
  command
      .add_option(
          "--engine", arguments.engine,
          "Where the sessions run: local; slurm: in job arrays of a cluster; print: nowhere, "
          "the plan and the script of the jobs are written and printed")
      ->capture_default_str()
      ->check(CLI::IsMember({"local", "slurm", "print"}));
  command
      .add_option("--slurm", arguments.slurm,
                  "What to ask of Slurm: key=value or a YAML file; may be repeated")
      ->allow_extra_args(false);
}

void addFreshOption(CLI::App& command, EngineArguments& arguments) {
  command.add_flag("--fresh", arguments.fresh,
                   "Start the program for each session, instead of once for each job");
}

void requireEngine(const EngineArguments& arguments) {
  evaluation::slurmOptionsOf(arguments.slurm);
  if (arguments.engine == "slurm") evaluation::requireSlurm();
}

std::vector<evaluation::RunRecord> executeOn(const EngineArguments& arguments,
                                             const std::vector<evaluation::PlannedRun>& plan,
                                             evaluation::ExecutorOptions options, bool attach,
                                             BatchProgress& progress,
                                             const std::atomic<bool>& stop) {
  if (!arguments.fresh) options.server = {"serve"};
  options.jobs = arguments.jobs;
  options.lease.program = arguments.command;
  options.repeated = [&](const auto& cause, const auto& ids) { progress.repeated(cause, ids); };
  options.ended = [&](const evaluation::RunRecord& record) { progress.ended(record, false); };
  options.kept = [&](const evaluation::RunRecord& record) { progress.ended(record, true); };
  auto records = arguments.isLocal() && !attach
                     ? evaluation::executeRuns(plan, options, stop)
                     : executeElsewhere(arguments, plan, options, attach, progress, stop);
  progress.finish();
  return records;
}

void requireNoWorker(const fs::path& results) {
  requireNoJobs(results);
  core::LeaseFolder leases(evaluation::leaseFolder(results), {});
  for (bool told = false;; told = true) {
    leases.removeLeftBehind();
    const auto holders = leases.holders();
    if (holders.empty()) return;
    for (const auto& [id, holder] : holders) requireSilent(results, id, holder);
    if (!told) {
      std::cerr << "waiting at most " << core::formatNumber(core::LeaseTerms().expiry)
                << " s for a sign of " << holders.begin()->second.text << "\n";
    }
    std::this_thread::sleep_for(kLeaseLook);
  }
}

void cancelEngine(const fs::path& results) {
  evaluation::requireSlurm();
  const std::string name = evaluation::readJobName(fs::absolute(results));
  evaluation::cancelJobs(name);
  std::cerr << "canceled " << name << "\n";
}

}  // namespace cdiff::cli
