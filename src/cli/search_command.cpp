// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The command `cdiff search`: searches a scenario for the sessions that are worst for its ego.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "cli/batch_engine.h"
#include "cli/commands.h"
#include "cli/progress.h"
#include "core/file.h"
#include "core/output_folder.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/search/search_page.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;
using core::InputError;
using evaluation::RunRecord;

constexpr const char* kSearchFile = "search.yaml";

struct SearchArguments {
  evaluation::SearchRequest request;
  std::string space = "default";
  std::string method;
  std::string results;
  EngineArguments engine;
  bool resume = false;
  bool cancel = false;
};

/// What decides the cases of a search, as the folder keeps it. The budget is none of it: a search
/// may go on for longer.
struct SearchIdentity {
  evaluation::SearchRequest request;

  void describe(core::OptionsVisitor& visitor) {
    visitor.text({"scenario", "", "Scenario that is searched."}, request.scenario, {});
    visitor.text({"mode", "", "Its mode; empty: the scenario's."}, request.mode, {});
    visitor.text({"ego", "", "Planner of the ego with options; empty: the scenario's."},
                 request.ego, {});
    visitor.text({"cbv_planner", "", "Planner of the CBVs; empty: the scenario's."},
                 request.cbv_planner, {});
    visitor.list({"set", "", "Overrides of all cases."}, request.set);
    auto seed = static_cast<std::int64_t>(request.seed);
    visitor.integer({"seed", "", "Of the proposals."}, seed, 0, 2147483647);
    request.seed = static_cast<std::uint64_t>(seed);
    visitor.group({"space", "", "What is varied, and how."}, request.options);
  }
};

std::string identityText(const evaluation::SearchRequest& request) {
  return core::dumpOptions(SearchIdentity{request});
}

/// Refuses a folder that holds something else, or a search that is not to be resumed.
void requireFolderFor(const fs::path& folder, const std::string& identity, bool resume) {
  if (core::isFile(folder / "session.yaml") || core::isFile(folder / "matrix.yaml"))
    throw InputError("'" + folder.string() +
                     "' holds the results of a session or a batch; give another --results");
  const fs::path file = folder / kSearchFile;
  if (!core::isFile(file)) return;
  if (!resume)
    throw InputError("'" + folder.string() + "' holds the results of a search (" + kSearchFile +
                     "); go on with it (--resume) or give another --results");
  if (core::readFile(file, "search", core::kLargestOptionsFile) != identity)
    throw InputError("'" + folder.string() + "' holds the results of another search, see " +
                     file.string() + "; expected the same scenario, ego, keys and seed");
}

evaluation::SearchRequest requestOf(const SearchArguments& arguments) {
  evaluation::SearchRequest request = arguments.request;
  request.options = evaluation::loadSearchOptions(arguments.space);
  if (!arguments.method.empty()) request.options.method = arguments.method;
  request.options_source = "search space '" + arguments.space + "'";
  if (core::isFile(request.scenario)) request.scenario = fs::absolute(request.scenario).string();
  return request;
}

/// How the engine runs a batch of the search.
std::vector<RunRecord> runBatch(const std::vector<evaluation::PlannedRun>& plan,
                                const SearchArguments& arguments,
                                const evaluation::SearchOptions& search, const fs::path& results,
                                const std::atomic<bool>& stop) {
  BatchProgress progress(plan, arguments.engine.jobs);
  evaluation::ExecutorOptions options;
  options.results = results;
  options.timeout = search.timeout;
  options.retries = static_cast<int>(search.retries);
  options.resume = arguments.resume;
  return executeOn(arguments.engine, plan, options, false, progress, stop);
}

int exitCodeOf(const evaluation::Search& search, const SearchArguments& arguments) {
  if (core::stopRequested()) return ExitCode::kInterrupted;
  const auto& cases = search.cases();
  const bool broke = std::any_of(cases.begin(), cases.end(), [](const auto& one) {
    return one.record.failed() || one.careful_broke;
  });
  const bool cut = cases.size() < arguments.request.budget && !arguments.engine.prints() &&
                   !search.isExhausted();
  return broke || cut ? ExitCode::kRunTimeError : ExitCode::kPassed;
}

void advanceAll(evaluation::Search& search, const evaluation::SearchRequest& request,
                const SearchArguments& arguments, const fs::path& results) {
  const std::atomic<bool>& stop = core::catchStopSignals();
  const auto run = [&](const std::vector<evaluation::PlannedRun>& plan) {
    return runBatch(plan, arguments, request.options, results, stop);
  };
  while (!stop && search.advance(results, run)) {
    std::cerr << evaluation::searchText(search.cases(), search.asksCarefulDriver()) << " ("
              << search.cases().size() << " of " << request.budget << ")\n";
  }
}

int searchScenario(const SearchArguments& arguments) {
  if (arguments.cancel) {
    cancelEngine(arguments.results);
    return ExitCode::kPassed;
  }
  requireEngine(arguments.engine);
  const evaluation::SearchRequest request = requestOf(arguments);
  if (request.scenario.empty()) throw InputError("give a scenario: a file or a shipped name");
  if (request.budget == 0) throw InputError("give --budget N, the number of cases");
  evaluation::Search search(request);
  const fs::path results = fs::absolute(arguments.results);
  const std::string identity = identityText(request);
  requireFolderFor(results, identity, arguments.resume);
  core::OutputFolder output(results, arguments.engine.command);
  requireFolderFor(results, identity, arguments.resume);
  requireNoWorker(results);
  output.removeUnfinished();
  output.subfolder("runs");
  output.write(kSearchFile, identity);
  for (const std::string& key : search.space().leftOut())
    std::cerr << "left out: " << key << " does not act on this scenario's demand\n";
  advanceAll(search, request, arguments, results);
  output.requireInPlace();
  evaluation::writeSearchFiles(search, request, results);
  std::cout << evaluation::searchText(search.cases(), search.asksCarefulDriver()) << "\n"
            << std::flush;
  if (search.cases().size() < arguments.request.budget && !arguments.engine.prints())
    std::cerr << (search.isExhausted() ? "the space has no further case than these "
                                       : "ended before its budget, after ")
              << search.cases().size() << "\n";
  std::cerr << "report: " << (results / "index.html").string() << "\n";
  return exitCodeOf(search, arguments);
}

/// What is searched, in what, and for which ego.
void addRequestOptions(CLI::App& command, SearchArguments& arguments) {
  evaluation::SearchRequest& request = arguments.request;
  command.add_option("scenario", request.scenario, "Scenario file or shipped name");
  command.add_option("--budget", request.budget, "Cases that are run")
      ->check(CLI::Range(1, 100000));
  command.add_option("--results,--output", arguments.results, "Result folder")->required();
  command
      .add_option("--space", arguments.space,
                  "What is varied: a YAML file, or the name of a shipped one")
      ->capture_default_str();
  command
      .add_option("--method", arguments.method,
                  "Instead of the one in --space: evolution makes new cases of the worst so far; "
                  "random draws all")
      ->check(CLI::IsMember({"evolution", "random"}));
  command.add_option("--seed", request.seed, "Of the proposals; the scenario keeps its own")
      ->capture_default_str()
      ->check(CLI::Range(0, 2147483647));
}

/// What all cases have in common, instead of the scenario's own.
void addOverrideOptions(CLI::App& command, evaluation::SearchRequest& request) {
  command.add_option("--mode", request.mode,
                     "naturalistic, challenging or safety_critical, instead of the scenario's");
  command.add_option("--ego", request.ego,
                     "Planner of the ego, also one of a plug-in, with options as 'NAME key=value "
                     "...'");
  command.add_option("--cbv-planner", request.cbv_planner, "Planner of the CBVs");
  command
      .add_option("--set", request.set,
                  "Any key of the scenario as key=value, for all cases; may be repeated")
      ->allow_extra_args(false);
}

}  // namespace

void addSearchCommand(CLI::App& program, int& exit_code) {
  auto arguments = std::make_shared<SearchArguments>();
  arguments->engine.command = "cdiff search";
  arguments->engine.go_on = "to go on once they have ended: the same command with --resume";
  CLI::App* command = program.add_subcommand(
      "search", "Search a scenario for the sessions that are worst for its ego");
  addRequestOptions(*command, *arguments);
  addOverrideOptions(*command, arguments->request);
  addEngineOptions(*command, arguments->engine);
  addFreshOption(*command, arguments->engine);
  CLI::Option* resume =
      command->add_flag("--resume", arguments->resume,
                        "Go on with the search in the folder; --budget may be larger than before");
  command
      ->add_flag("--cancel", arguments->cancel,
                 "End the jobs of a search on Slurm; --resume goes on with it")
      ->excludes(resume);
  command->footer(
      "Exit codes: 0 the budget is spent, whatever was found; 2 a session broke or was "
      "not run; 3 wrong input; 130 interrupted.");
  command->callback([arguments, &exit_code] { exit_code = searchScenario(*arguments); });
}

}  // namespace cdiff::cli
