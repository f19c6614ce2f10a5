// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The command `cdiff evaluate`: runs a matrix of sessions in parallel and sums it up.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <memory>
#include <set>
#include <vector>

#include "cli/batch_engine.h"
#include "cli/bench2drive_table.h"
#include "cli/commands.h"
#include "cli/progress.h"
#include "core/file.h"
#include "core/output_folder.h"
#include "core/program.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/batch_files.h"
#include "evaluation/batch_report.h"
#include "evaluation/executor.h"
#include "evaluation/matrix.h"
#include "evaluation/paper/table_definitions.h"
#include "evaluation/plan_file.h"
#include "evaluation/run_plan.h"
#include "evaluation/separation/ego_ranking.h"
#include "evaluation/suite_selection.h"
#include "planners/registry.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;
using core::InputError;
using evaluation::MatrixOptions;
using evaluation::RunRecord;

struct EvaluateArguments {
  std::string matrix;
  std::string bench2drive;
  std::string networks;
  std::string results;
  std::string suite;
  std::string open_sealed;
  std::vector<std::string> routes;
  std::vector<std::string> seeds;
  std::vector<std::string> set;
  std::vector<std::string> only;
  std::string ego;
  EngineArguments engine;
  bool resume = false;
  bool overwrite = false;
  bool strict = false;
  bool attach = false;
  bool cancel = false;
};

constexpr const char* kMatrixFile = "matrix.yaml";
/// What a batch writes beside its runs, and what --overwrite replaces.
const std::vector<std::string> kBatchFiles = {
    "runs.csv",     "summary.json",    "summary.md",       "junit.xml",
    "index.html",   "table.md",        "compare.csv",      "engine.json",
    "left_out.txt", "ego_ranking.csv", "ego_ranking.html", evaluation::PlanFile::kName,
    kMatrixFile};
const std::vector<std::string> kBatchFolders = {"runs", "tables", "figures"};
constexpr const char* kJobFolder = "slurm";

/// The Bench2Drive routes of the arguments.
evaluation::Bench2DriveOptions routesOf(const EvaluateArguments& arguments) {
  if (arguments.networks.empty()) {
    throw InputError("--bench2drive " + arguments.bench2drive +
                     " needs --networks DIR (a folder with TOWN.net.xml files)");
  }
  return {fs::absolute(arguments.bench2drive).string(), fs::absolute(arguments.networks).string(),
          arguments.routes};
}

/// The name of a shipped suite, or the absolute path of a folder.
std::string suiteOf(const std::string& name) {
  return core::isFile(fs::path(name) / "suite.yaml") ? fs::absolute(name).string() : name;
}

/// The matrix on its own routes or on those of the arguments; without a matrix these routes with
/// everything as scenarios have it.
MatrixOptions baseMatrix(const EvaluateArguments& arguments) {
  const bool suite = !arguments.suite.empty();
  const bool bench2drive = !arguments.bench2drive.empty();
  if (arguments.attach) return evaluation::loadMatrix(fs::path(arguments.results) / kMatrixFile);
  if (arguments.matrix.empty() && !suite && !bench2drive) {
    throw InputError(
        "give a matrix (file or shipped name), or routes: --suite NAME, or --bench2drive FILE "
        "--networks DIR, or a matrix and the routes to run it on instead of its own");
  }
  if (!bench2drive && (!arguments.networks.empty() || !arguments.routes.empty()))
    throw InputError("--networks and --routes are for --bench2drive FILE, which is missing");
  if (suite && bench2drive)
    throw InputError("give either --suite or --bench2drive: a batch has routes of one kind");
  MatrixOptions matrix;
  matrix.name = suite ? evaluation::suiteName(arguments.suite) : "bench2drive";
  if (!arguments.matrix.empty()) matrix = evaluation::loadMatrix(arguments.matrix);
  if (!suite && !bench2drive) return matrix;
  matrix.scenarios.clear();
  matrix.suite = suite ? suiteOf(arguments.suite) : "";
  matrix.bench2drive = bench2drive ? routesOf(arguments) : evaluation::Bench2DriveOptions();
  return matrix;
}

/// One more ego of a matrix, "NAME" or "NAME key=value ...": one more planner, or a variant where
/// it has options or where the matrix has variants, beside which its planners become variants.
void addEgo(const std::string& ego, MatrixOptions& matrix) {
  const std::string name = ego.substr(0, ego.find(' '));
  if (!matrix.combinations.empty()) {
    throw InputError("--ego " + name +
                     ": the matrix names combinations; expected one with ego_planners or variants");
  }
  std::vector<std::string>& egos = matrix.ego_planners;
  if (matrix.variants.empty()) {
    if (name == ego && !egos.empty()) {
      egos.push_back(name);
      return;
    }
    if (egos.empty()) matrix.variants = {"scenario:"};
    for (const std::string& planner : egos)
      matrix.variants.push_back(planner + ": ego_planner=" + planner);
    egos.clear();
  } else if (egos.size() > 1) {
    throw InputError("--ego " + name +
                     ": the matrix combines several ego_planners with variants; expected one of "
                     "the two. Add it to the matrix");
  }
  const bool taken = std::any_of(
      matrix.variants.begin(), matrix.variants.end(),
      [&](const std::string& variant) { return variant.substr(0, variant.find(':')) == name; });
  matrix.variants.push_back((taken ? name + "_added" : name) + ": ego_planner=" + ego);
}

MatrixOptions matrixOf(const EvaluateArguments& arguments) {
  MatrixOptions matrix = baseMatrix(arguments);
  if (!arguments.seeds.empty()) matrix.seeds = arguments.seeds;
  if (!arguments.open_sealed.empty()) matrix.open_sealed = arguments.open_sealed;
  matrix.set.insert(matrix.set.end(), arguments.set.begin(), arguments.set.end());
  if (!arguments.ego.empty()) addEgo(arguments.ego, matrix);
  return matrix;
}

/// Refuses the folder of a session, and that of a batch which is neither resumed nor replaced.
void requireFolder(const fs::path& folder, const EvaluateArguments& arguments) {
  std::error_code error;
  if (fs::exists(folder / "session.yaml", error)) {
    throw InputError("'" + folder.string() +
                     "' holds the result of a session (session.yaml); give another --results");
  }
  const bool goes_on = arguments.resume || arguments.overwrite || arguments.attach;
  if (!goes_on && fs::exists(folder / kMatrixFile, error)) {
    throw InputError("'" + folder.string() + "' holds the results of a batch (" + kMatrixFile +
                     "); go on with it (--resume), replace it (--overwrite), or give another "
                     "--results");
  }
  std::vector<std::string> names = kBatchFiles;
  if (!arguments.open_sealed.empty()) names.emplace_back("opened.log");
  core::OutputFolder::requireFree(folder, names);
}

/// Slurm wrote the logs in it, so they are on no record of ours.
void removeJobFolder(core::OutputFolder& output) {
  for (const auto& entry : fs::directory_iterator(output.path() / kJobFolder)) {
    if (entry.path().extension() == ".log" && entry.is_regular_file()) fs::remove(entry.path());
  }
  core::OutputFolder(output.path() / kJobFolder).clear();
  output.remove({kJobFolder});
}

/// Makes what a batch needs in a folder that is ours, and keeps the matrix in it; on resumption
/// that of another matrix is refused.
void prepareFolder(core::OutputFolder& output, const MatrixOptions& matrix, bool overwrite) {
  if (overwrite) {
    output.remove({kBatchFiles.begin(), kBatchFiles.end()});
    for (const std::string& name : output.names()) {
      if (name.rfind("what_if_", 0) == 0) output.remove({name});
    }
    for (const std::string& name : kBatchFolders) {
      // One that was the user's stays, and what the program made in it goes.
      if (fs::is_directory(output.path() / name)) core::OutputFolder(output.path() / name).clear();
    }
    output.remove({kBatchFolders.begin(), kBatchFolders.end()});
    output.remove({evaluation::kLeftBehindFolder});
    if (fs::is_directory(output.path() / kJobFolder)) removeJobFolder(output);
  }
  const fs::path file = output.path() / kMatrixFile;
  if (fs::exists(file)) {
    MatrixOptions earlier;
    core::loadOptions(
        {file.string(), core::readFile(file, "evaluation", core::kLargestOptionsFile)}, earlier);
    if (evaluation::identityOf(earlier) != evaluation::identityOf(matrix)) {
      throw InputError("'" + output.path().string() + "' holds the results of another matrix ('" +
                       earlier.name + "', see " + file.string() + "); give another --results");
    }
  }
  output.removeUnfinished();
  for (const std::string& name : kBatchFolders) output.subfolder(name);
  std::vector<std::string> tables = {"tables.md"};
  for (const evaluation::TableDefinition& table : evaluation::paperTables())
    tables.push_back(table.id + ".csv");
  core::OutputFolder::requireFree(output.path() / "tables", tables);
  output.write(kMatrixFile, core::dumpOptions(matrix));
}

/// Of the runs that were to be run.
int exitCodeOf(const std::vector<RunRecord>& records,
               const std::vector<evaluation::PlannedRun>& plan,
               const evaluation::ChosenLevels& chosen) {
  if (core::stopRequested()) return ExitCode::kInterrupted;
  int exit_code = ExitCode::kPassed;
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (!evaluation::isChosen(plan[i], chosen)) continue;
    const RunRecord& record = records[i];
    const bool bad_input = record.failed() && record.exit_code == ExitCode::kBadInput;
    if (!record.complete() && !bad_input) return ExitCode::kRunTimeError;
    if (bad_input) exit_code = ExitCode::kBadInput;
    if (record.has(record::Outcome::kFailed) && exit_code == ExitCode::kPassed)
      exit_code = ExitCode::kVerdictFailed;
  }
  return exit_code;
}

std::vector<RunRecord> execute(const std::vector<evaluation::PlannedRun>& plan,
                               const MatrixOptions& matrix, const fs::path& results,
                               const EvaluateArguments& arguments,
                               const evaluation::ChosenLevels& chosen) {
  const auto isNow = [&](const auto& run) { return evaluation::isChosen(run, chosen); };
  std::vector<evaluation::PlannedRun> now;
  std::copy_if(plan.begin(), plan.end(), std::back_inserter(now), isNow);
  BatchProgress progress(now, arguments.engine.jobs);
  evaluation::ExecutorOptions options;
  options.results = results;
  options.timeout = matrix.timeout;
  options.retries = static_cast<int>(matrix.retries);
  options.resume = arguments.resume;
  options.chosen = isNow;
  return executeOn(arguments.engine, plan, options, arguments.attach, progress,
                   core::catchStopSignals());
}

/// Without the runs whose levels do not fit together, or with --strict refused for them.
std::vector<evaluation::PlannedRun> planOf(const MatrixOptions& matrix,
                                           const EvaluateArguments& arguments,
                                           std::vector<std::string>& left_out) {
  const std::string source = arguments.matrix.empty() ? "evaluate" : arguments.matrix;
  if (arguments.strict) return evaluation::planRuns(matrix, source);
  return evaluation::planFittingRuns(matrix, source, left_out);
}

/// Runs of a scenario that has another name by now, or is gone, would count in tables and pages.
void requireNoOthers(const fs::path& results, const std::vector<evaluation::PlannedRun>& plan) {
  std::set<std::string> ids;
  for (const evaluation::PlannedRun& run : plan) ids.insert(run.id);
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(results / "runs", none)) {
    const std::string id = entry.path().filename().string();
    if (ids.count(id) != 0 || !core::isFile(entry.path() / evaluation::kRecordFile)) continue;
    throw InputError("'" + entry.path().string() +
                     "' holds a run that the matrix does not have any more; give another "
                     "--results, or begin again (--overwrite)");
  }
}

/// On standard error, and in a file for the batch's page.
void noteLeftOut(core::OutputFolder& output, const std::vector<std::string>& left_out) {
  if (left_out.empty()) {
    output.remove({evaluation::kSkippedFile});
    return;
  }
  for (const std::string& line : left_out)
    std::cerr << "left out: " << line << " (--strict refuses it)\n";
  output.write(evaluation::kSkippedFile, core::joinText(left_out, "\n") + "\n");
}

/// Writes the batch's files and prints its table; `repeated`: routes that run once.
void sumUp(const MatrixOptions& matrix, const EvaluateArguments& arguments,
           core::OutputFolder& output, const std::vector<RunRecord>& records,
           const std::string& repeated) {
  const fs::path& results = output.path();
  output.requireInPlace();
  evaluation::writeBatchFiles(results, matrix.name, records);
  evaluation::writeBatchReport(results, matrix.name);
  std::string text = evaluation::batchMarkdown(matrix.name, records) + repeated;
  if (matrix.ego_ranking) text += evaluation::writeEgoRanking({results}, matrix.name);
  if (arguments.matrix.empty() && !arguments.bench2drive.empty()) {
    text = routeTable(records, arguments.bench2drive, results) + repeated;
    output.write("table.md", text);
  }
  std::cout << text << std::flush;
  std::cerr << "report: " << (results / "index.html").string() << "\n";
}

int evaluate(const EvaluateArguments& arguments) {
  if (arguments.cancel) {
    cancelEngine(arguments.results);
    return ExitCode::kPassed;
  }
  if (arguments.results.empty()) throw InputError("--results is empty; expected a folder");
  requireEngine(arguments.engine);
  const MatrixOptions matrix = matrixOf(arguments);
  const fs::path results = fs::absolute(arguments.results);
  requireFolder(results, arguments);
  core::temporaryFolder();  // without one each run would fail
  std::string repeated;
  if (!matrix.bench2drive.file.empty())
    repeated = evaluation::repeatedText(evaluation::selectBench2Drive(matrix.bench2drive));
  std::vector<std::string> left_out;
  const auto plan = planOf(matrix, arguments, left_out);
  const evaluation::ChosenLevels chosen = evaluation::chosenLevels(arguments.only, plan);
  core::OutputFolder output(results, "cdiff evaluate");
  requireFolder(results, arguments);
  if (!arguments.attach) requireNoWorker(results);
  if (arguments.resume) requireNoOthers(results, plan);
  prepareFolder(output, matrix, arguments.overwrite);
  std::cerr << evaluation::recordOpening(matrix, results) << repeated;
  noteLeftOut(output, left_out);
  const auto records = execute(plan, matrix, results, arguments, chosen);
  if (arguments.engine.prints() && !arguments.attach) return ExitCode::kPassed;
  sumUp(matrix, arguments, output, records, repeated);
  return exitCodeOf(records, plan, chosen);
}

}  // namespace

namespace {

/// `replaced` are the options of a batch that is to be run, which --attach and --cancel exclude.
void addJobOptions(CLI::App& command, EvaluateArguments& arguments,
                   const std::vector<CLI::Option*>& replaced) {
  CLI::Option* attach = command.add_flag("--attach", arguments.attach,
                                         "Follow the jobs of a batch on Slurm again and sum it up");
  CLI::Option* cancel = command.add_flag(
      "--cancel", arguments.cancel, "End the jobs of a batch on Slurm; --resume goes on with it");
  cancel->excludes(attach);
  for (CLI::Option* option : replaced) {
    attach->excludes(option);
    cancel->excludes(option);
  }
}

}  // namespace

void addEvaluateCommand(CLI::App& program, int& exit_code) {
  auto arguments = std::make_shared<EvaluateArguments>();
  CLI::App* command =
      program.add_subcommand("evaluate", "Run a matrix of sessions in parallel and sum it up");
  command->add_option("matrix", arguments->matrix, "Matrix file or shipped evaluation");
  command->add_option("--bench2drive", arguments->bench2drive,
                      "Routes instead of the matrix's, or without one: every Bench2Drive route of "
                      "this file whose town's network is at hand");
  command->add_option("--suite", arguments->suite,
                      "Routes instead of the matrix's, or without one: a shipped route suite, or "
                      "the folder of one");
  command->add_option("--networks", arguments->networks, "Folder with TOWN.net.xml files");
  command->add_option("--open-sealed", arguments->open_sealed,
                      "Why a sealed suite is opened; goes to opened.log");
  command
      ->add_option("--results", arguments->results, "Result folder; one folder a run below runs/")
      ->required();
  command
      ->add_option("--routes", arguments->routes,
                   "Only these Bench2Drive route ids; dev10: the paper's")
      ->delimiter(',');
  command->add_option("--seeds", arguments->seeds, "Root seeds instead of the matrix's")
      ->delimiter(',');
  command
      ->add_option("--set", arguments->set, "Any key of the scenario as key=value; may be repeated")
      ->allow_extra_args(false);
  command
      ->add_option("--only", arguments->only,
                   "Now only runs with these levels of a factor, as seed=1,2; may be repeated. The "
                   "others are left for --resume")
      ->allow_extra_args(false);
  command->add_option("--ego", arguments->ego,
                      "One more ego of the matrix: a planner, also one of a plug-in, with options "
                      "as 'NAME key=value ...'");
  command->add_flag("--strict", arguments->strict,
                    "Refuse a matrix with levels that do not fit together, instead of leaving "
                    "their runs out with a note");
  command->footer("Planners that can attack (mode safety_critical): " +
                  core::joinText(planners::guidedPlannerNames(), ", "));
  CLI::Option* resume = command->add_flag(
      "--resume", arguments->resume,
      "Run only what is not complete yet, or was run with other files or another program");
  CLI::Option* overwrite = command->add_flag(
      "--overwrite", arguments->overwrite, "Replace the results of an earlier batch in the folder");
  overwrite->excludes(resume);
  addEngineOptions(*command, arguments->engine);
  addFreshOption(*command, arguments->engine);
  addJobOptions(*command, *arguments, {resume, overwrite});
  command->callback([arguments, &exit_code] { exit_code = evaluate(*arguments); });
}

}  // namespace cdiff::cli
