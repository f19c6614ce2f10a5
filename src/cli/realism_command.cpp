// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The command `cdiff realism`: how realistic driving is, by the realism meta-metric.
#include <filesystem>
#include <iostream>
#include <memory>

#include "cli/batch_engine.h"
#include "cli/commands.h"
#include "cli/realism_recordings.h"
#include "core/file.h"
#include "core/output_folder.h"
#include "core/program.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/matrix.h"
#include "evaluation/suite_selection.h"
#include "realism/matched_realism.h"
#include "realism/pooled_realism.h"
#include "realism/realism_tables.h"
#include "session/session_request.h"
#include "suite/seal.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;
using core::InputError;

struct MatchedArguments {
  std::string matrix;
  std::string results;
  std::vector<std::string> seeds;
  std::vector<std::string> set;
  realism::ContinuationOptions options;
  EngineArguments engine;
  bool resume = false;
  bool cancel = false;
};

struct ContinueArguments {
  std::string scenario;
  std::string driver;
  realism::ContinuationOptions options;
  std::string out;
};

struct PooledArguments {
  std::vector<std::string> results;
  std::vector<std::string> log;
  std::string site;
  std::string out;
  bool overwrite = false;
};

constexpr const char* kSumoDriver = "sumo";
constexpr const char* kResultFile = "realism.json";
const std::vector<std::string> kResultFiles = {kResultFile, "realism.md", "realism.html"};

void writeResult(core::OutputFolder& folder, const std::string& json, const std::string& markdown,
                 const std::string& page) {
  folder.write(kResultFile, json);
  folder.write("realism.md", markdown);
  folder.write("realism.html", page);
  std::cout << markdown << "\npage: " << (folder.path() / "realism.html").string() << "\n";
}

void requireMatchedFolder(const fs::path& folder, bool resume) {
  if (core::isFile(folder / "matrix.yaml") || core::isFile(folder / "session.yaml"))
    throw InputError("'" + folder.string() +
                     "' holds the results of a batch or session; give another --results");
  core::OutputFolder::requireFree(folder, kResultFiles);
  if (resume || !fs::exists(folder / "runs")) return;
  throw InputError("'" + folder.string() +
                   "' holds earlier results; go on with them (--resume) or give another --results");
}

evaluation::MatrixOptions matrixOf(const MatchedArguments& arguments) {
  if (arguments.matrix.empty()) throw InputError("give a matrix: a file or a shipped evaluation");
  evaluation::MatrixOptions matrix = evaluation::loadMatrix(arguments.matrix);
  if (!arguments.seeds.empty()) matrix.seeds = arguments.seeds;
  matrix.set.insert(matrix.set.end(), arguments.set.begin(), arguments.set.end());
  return matrix;
}

/// Runs the jobs on the engine; gives how they ended.
std::vector<realism::MatchedEnd> runMatched(const std::vector<realism::MatchedJob>& jobs,
                                            const MatchedArguments& arguments,
                                            const fs::path& folder) {
  constexpr double kLongest = 3600.0;  // of one job [s]
  std::vector<evaluation::PlannedRun> plan;
  for (const realism::MatchedJob& job : jobs) plan.push_back(job.run);
  evaluation::ExecutorOptions options;
  options.results = folder;
  options.timeout = kLongest;
  options.resume = arguments.resume;
  BatchProgress progress(plan, arguments.engine.jobs);
  const auto records =
      executeOn(arguments.engine, plan, options, false, progress, core::catchStopSignals());
  return realism::endsOf(records, folder);
}

int matched(const MatchedArguments& arguments) {
  if (arguments.cancel) {
    cancelEngine(arguments.results);
    return ExitCode::kPassed;
  }
  requireEngine(arguments.engine);
  const evaluation::MatrixOptions matrix = matrixOf(arguments);
  const fs::path folder = fs::absolute(arguments.results);
  requireMatchedFolder(folder, arguments.resume);
  const auto jobs =
      realism::planMatched(evaluation::planRuns(matrix, arguments.matrix), arguments.options);
  core::OutputFolder output(folder, "cdiff realism matched");
  requireNoWorker(folder);
  std::cerr << evaluation::recordOpening(matrix, folder);
  const auto ends = runMatched(jobs, arguments, folder);
  if (arguments.engine.prints()) return ExitCode::kPassed;
  const auto rows = realism::matchedRows(jobs, ends);
  writeResult(output, realism::matchedJson(rows, arguments.options),
              realism::matchedMarkdown(rows, arguments.options),
              realism::matchedPage(rows, arguments.options));
  if (core::stopRequested()) return ExitCode::kInterrupted;
  for (const realism::MatchedEnd& end : ends) {
    if (!end.score) return ExitCode::kRunTimeError;
  }
  return ExitCode::kPassed;
}

int continueScenario(const ContinueArguments& arguments) {
  suite::requireOpen(arguments.scenario);
  session::SessionRequest request;
  request.scenario = arguments.scenario;
  const session::SessionSetup setup(session::resolveRequest(request));
  const std::string planner = arguments.driver == kSumoDriver ? "" : arguments.driver;
  const auto score = realism::scoreDriver(setup, planner, arguments.options);
  core::writeFileAtomically(arguments.out, realism::scoreJson(score));
  return ExitCode::kPassed;
}

/// Refuses to replace an earlier comparison unless asked to.
void requirePooledFolder(const fs::path& folder, bool overwrite) {
  core::OutputFolder::requireFree(folder, kResultFiles);
  if (overwrite || !core::isFile(folder / kResultFile)) return;
  throw InputError("'" + folder.string() + "' holds an earlier comparison (" + kResultFile +
                   "); replace it (--overwrite) or give another --out");
}

int pooled(const PooledArguments& arguments) {
  requirePooledFolder(fs::absolute(arguments.out), arguments.overwrite);
  const std::vector<fs::path> files(arguments.log.begin(), arguments.log.end());
  const auto log = readLogs(files);
  const auto drivers = pooledDrivers({arguments.results.begin(), arguments.results.end()});
  const auto result = realism::comparePooled(log, drivers, arguments.site);
  const fs::path folder = fs::absolute(arguments.out);
  core::OutputFolder output(folder, "cdiff realism pooled");
  writeResult(output, realism::pooledJson(result), realism::pooledMarkdown(result),
              realism::pooledPage(result));
  return ExitCode::kPassed;
}

void addRollouts(CLI::App* command, realism::ContinuationOptions& options) {
  command->add_option("--rollouts", options.rollouts, "Rollouts of each driver")
      ->capture_default_str()
      ->check(CLI::Range(1, 10000));
  command->add_option("--seconds", options.seconds, "Time after the hand-over [s]")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 60.0));
}

void addMatched(CLI::App* realism, int& exit_code) {
  auto arguments = std::make_shared<MatchedArguments>();
  CLI::App* command = realism->add_subcommand(
      "matched", "Rollouts from the first hand-over against PDM-Lite (realism_matched)");
  arguments->engine.command = "cdiff realism matched";
  arguments->engine.go_on = "to go on once they have ended: the same command with --resume";
  arguments->engine.fresh = true;
  command->add_option("matrix", arguments->matrix, "Matrix file or shipped evaluation");
  command->add_option("--results", arguments->results, "Result folder")->required();
  command->add_option("--seeds", arguments->seeds, "Root seeds instead of the matrix's")
      ->delimiter(',');
  command
      ->add_option("--set", arguments->set, "Any key of the scenario as key=value; may be repeated")
      ->allow_extra_args(false);
  addEngineOptions(*command, arguments->engine);
  CLI::Option* resume =
      command->add_flag("--resume", arguments->resume, "Keep the scores of jobs that are the same");
  command
      ->add_flag("--cancel", arguments->cancel,
                 "End the jobs of a folder on Slurm; --resume goes on with it")
      ->excludes(resume);
  addRollouts(command, arguments->options);
  command->callback([arguments, &exit_code] { exit_code = matched(*arguments); });
}

void addContinue(CLI::App* realism, int& exit_code) {
  auto arguments = std::make_shared<ContinueArguments>();
  CLI::App* command = realism->add_subcommand(
      "continue", "One driver in one session, as `matched` runs it in a process of its own");
  command->add_option("scenario", arguments->scenario, "Scenario name or file")->required();
  command->add_option("--driver", arguments->driver, "Planner of the CBVs, or sumo")->required();
  command->add_option("--out", arguments->out, "File of the score")->required();
  addRollouts(command, arguments->options);
  command->callback([arguments, &exit_code] { exit_code = continueScenario(*arguments); });
}

void addPooled(CLI::App* realism, int& exit_code) {
  auto arguments = std::make_shared<PooledArguments>();
  CLI::App* command = realism->add_subcommand(
      "pooled", "Vehicles of results against recorded drivers (realism_pooled)");
  command
      ->add_option("results", arguments->results,
                   "Result folders of `cdiff run` and `cdiff evaluate`")
      ->required();
  command
      ->add_option("--log", arguments->log,
                   "CSV files of recorded traffic, folders of them, or session bags")
      ->required();
  command->add_option("--site", arguments->site,
                      "Site of the headline (default: Lanker, else the first)");
  command->add_option("--out", arguments->out, "Folder of realism.json, .md and .html")->required();
  command->add_flag("--overwrite", arguments->overwrite,
                    "Replace an earlier comparison in the folder");
  command->callback([arguments, &exit_code] { exit_code = pooled(*arguments); });
}

}  // namespace

void addRealismCommand(CLI::App& program, int& exit_code) {
  CLI::App* realism =
      program.add_subcommand("realism", "How likely driving is, against other drivers");
  realism->require_subcommand(1);
  addMatched(realism, exit_code);
  addContinue(realism, exit_code);
  addPooled(realism, exit_code);
}

}  // namespace cdiff::cli
