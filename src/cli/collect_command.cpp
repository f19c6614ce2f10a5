// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The command `cdiff collect`: drives sessions, or reads bags, and makes training samples.
#include <algorithm>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <set>

#include "cli/batch_engine.h"
#include "cli/commands.h"
#include "collection/dataset_statistics.h"
#include "core/file.h"
#include "core/markup.h"
#include "core/output_folder.h"
#include "core/program.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/run_plan.h"
#include "learning/samples/dataset.h"
#include "learning/samples/scene_file.h"
#include "node_graph/bags/dataset_from_bag.h"
#include "suite/seal.h"
#include "suite/suite.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;
using collection::CollectRequest;

constexpr const char* kSessionCommand = "collect_session";
constexpr const char* kLockedBy = "cdiff collect";
/// What describes the data set.
const std::vector<std::string> kDatasetFiles = {"statistics.json", "samples.html"};

struct CollectArguments {
  CollectRequest request;
  std::vector<std::string> scenarios;
  std::string suite;  ///< name or folder
  node_graph::BagRequest bags;
  int seeds = 1;
  int first_seed = 1;
  EngineArguments engine;
  bool cancel = false;
};

/// Arguments of the program, as the command of a run.
std::vector<std::string> wordsOf(const CollectRequest& request) {
  const std::string scenario =
      core::isFile(request.scenario) ? fs::absolute(request.scenario).string() : request.scenario;
  std::vector<std::string> words = {kSessionCommand, scenario,
                                    "--seed",        std::to_string(request.seed),
                                    "--results",     "{results}",
                                    "--duration",    core::formatNumber(request.duration),
                                    "--planned",     "{run}/scenario.yaml"};
  if (request.keep_bag) words.push_back("--keep-bags");
  if (!request.images) words.push_back("--no-images");
  if (request.scenes) words.push_back("--scenes");
  for (const std::string& assignment : request.set) {
    words.push_back("--set");
    words.push_back(assignment);
  }
  return words;
}

/// A scenario and what is set for it alone.
struct CollectScenario {
  std::string name;
  std::vector<std::string> set;
};

/// Those named and those of the suite, whose traffic stays as the suite has it; all that are
/// shipped when none is asked for.
std::vector<CollectScenario> scenariosOf(const CollectArguments& arguments) {
  std::vector<CollectScenario> scenarios;
  for (const std::string& name : arguments.scenarios) scenarios.push_back({name, {}});
  if (!arguments.suite.empty()) {
    const suite::Suite routes = suite::loadSuite(arguments.suite);
    for (const suite::SuiteRoute& route : routes.routes) {
      const std::string density = std::to_string(suite::vehiclesAt(route.density));
      scenarios.push_back(
          {fs::weakly_canonical(routes.scenarioFile(route)).string(),
           {"collection.minimum_density=" + density, "collection.maximum_density=" + density}});
    }
  }
  std::vector<std::string> files;
  for (const CollectScenario& scenario : scenarios) {
    suite::requireNotSealed(scenario.name);
    files.push_back(scenario.name);
  }
  suite::requireForTraining(files);
  if (!scenarios.empty()) return scenarios;
  for (const std::string& name : session::shippedScenarios()) scenarios.push_back({name, {}});
  return scenarios;
}

std::vector<CollectRequest> planSessions(const CollectArguments& arguments) {
  std::vector<CollectRequest> sessions;
  const std::vector<CollectScenario> scenarios = scenariosOf(arguments);
  for (int i = 0; i < arguments.seeds; ++i) {
    for (const CollectScenario& scenario : scenarios) {
      CollectRequest request = arguments.request;
      request.scenario = scenario.name;
      request.set.insert(request.set.begin(), scenario.set.begin(), scenario.set.end());
      request.seed = arguments.first_seed + i;
      sessions.push_back(request);
    }
  }
  return sessions;
}

int exitCode(const std::vector<evaluation::RunRecord>& records) {
  int code = ExitCode::kPassed;
  for (const evaluation::RunRecord& record : records) {
    if (record.complete()) continue;
    if (record.exit_code != ExitCode::kBadInput) return ExitCode::kRunTimeError;
    code = ExitCode::kBadInput;
  }
  return code;
}

/// Removes what an earlier collection that was killed left half written.
void removeHalves(const fs::path& results) {
  for (const char* name : {"bags", "shards", "scenes", "sessions"}) {
    if (!fs::exists(fs::symlink_status(results / name))) continue;
    core::OutputFolder folder(results / name);
    folder.removeUnfinished();
    for (const auto& entry : fs::directory_iterator(folder.path())) {
      if (entry.path().extension() == ".active") folder.remove({entry.path().filename().string()});
    }
  }
}

int convertBags(const CollectArguments& arguments) {
  const core::OutputFolder output(arguments.request.results, kLockedBy);
  core::OutputFolder::requireFree(output.path(), kDatasetFiles);
  node_graph::BagRequest request = arguments.bags;
  request.results = arguments.request.results;
  const auto statistics = node_graph::collectBags(request);
  collection::describeDataset(request.results, collection::sumOf(statistics));
  collection::requireSamples(statistics, "bag", "longer bags");
  return ExitCode::kPassed;
}

/// Whether a file is there and whole, as its reader says; a damaged one is named.
bool isWhole(const fs::path& file, const std::function<void(const fs::path&)>& read) {
  if (!fs::exists(file)) return false;
  try {
    read(file);
    return true;
  } catch (const core::InputError& error) {
    std::cerr << "cdiff: " << core::plainText(error.what()) << "; its session is driven again\n";
    return false;
  }
}

/// Whether every file that the request asks for exists; a session of which only a bag is asked is
/// always driven again.
bool isDone(const CollectRequest& request, const std::string& name) {
  if (!request.images && !request.scenes) return false;
  const auto shard = [](const fs::path& file) { learning::ShardReader{file}; };
  const auto statistics = [](const fs::path& file) { collection::readStatistics(file); };
  const auto scene = [](const fs::path& file) { learning::readScene(file); };
  return (!request.images || (isWhole(collection::shardFile(request, name), shard) &&
                              isWhole(collection::statisticsFile(request, name), statistics))) &&
         (!request.scenes || isWhole(collection::sceneFile(request, name), scene));
}

/// The run of one session. Its files lie in the folders of the data set.
evaluation::PlannedRun runOf(const CollectRequest& request,
                             const collection::CollectSettings& settings,
                             evaluation::InputHasher& hasher) {
  evaluation::PlannedRun run;
  run.id = collection::sessionName(settings);
  for (const std::string& factor : evaluation::factorNames()) run.factors[factor] = "";
  run.factors["scenario"] = request.scenario;
  run.factors["seed"] = std::to_string(request.seed);
  run.scenario_text = core::dumpOptions(settings.scenario);
  run.scenario_sha256 = core::sha256(run.scenario_text);
  run.inputs = hasher.hashes(settings.scenario);
  run.command = {wordsOf(request), ""};
  return run;
}

/// What decides how a session is driven: its command without the scenario, which its hash stands
/// for, and without what says which files it leaves; keys in any order.
std::vector<std::string> drivingWords(std::vector<std::string> words) {
  const auto of_files = [](const std::string& word) {
    return word == "--keep-bags" || word == "--no-images" || word == "--scenes";
  };
  words.erase(std::remove_if(words.begin(), words.end(), of_files), words.end());
  if (words.size() > 1) words.erase(words.begin() + 1);
  std::sort(words.begin(), words.end());
  return words;
}

/// Files of the scenario that have changed, weights among them: samples of another program stay
/// good ones.
std::string changedFiles(const evaluation::RunRecord& there, const evaluation::PlannedRun& run) {
  if (there.inputs.empty()) return "";  // of an earlier version
  return evaluation::changedInputs(there.inputs, run.inputs, {"program"});
}

/// Throws InputError where samples or a scene of the session are there that were asked for with
/// other settings or files; those without a record, of an earlier version, count as they are.
void requireSameSettings(const evaluation::PlannedRun& run, const CollectRequest& request) {
  if (!fs::exists(collection::shardFile(request, run.id)) &&
      !fs::exists(collection::sceneFile(request, run.id)))
    return;
  const fs::path& results = request.results;
  const fs::path file = evaluation::runFolder(results, run.id) / evaluation::kRecordFile;
  const auto there = evaluation::readRecord(file);
  if (!there) return;
  const bool same = there->scenario_sha256 == run.scenario_sha256 &&
                    drivingWords(there->command.words) == drivingWords(run.command.words);
  const std::string changed = changedFiles(*there, run);
  if (same && changed.empty()) return;
  throw core::InputError("'" + results.string() + "' holds session " + run.id + " of other " +
                         (same ? "files: " + changed : "settings") + " (" + file.string() +
                         "); give another --results or another --first-seed");
}

/// The sessions that are still to be driven.
std::vector<evaluation::PlannedRun> planOf(const std::vector<CollectRequest>& sessions) {
  std::vector<evaluation::PlannedRun> plan;
  std::set<std::string> ids;
  evaluation::InputHasher hasher;
  for (const CollectRequest& request : sessions) {
    const auto settings = collection::resolveCollection(request);
    evaluation::PlannedRun run = runOf(request, settings, hasher);
    if (!ids.insert(run.id).second)
      throw core::InputError("session " + run.id + " is there twice (scenario '" +
                             request.scenario +
                             "'); give every scenario once and a name of its own");
    requireSameSettings(run, request);
    if (!isDone(request, run.id)) plan.push_back(std::move(run));
  }
  std::cerr << sessions.size() << " sessions, " << sessions.size() - plan.size()
            << " of them already there\n";
  return plan;
}

std::vector<evaluation::RunRecord> driveSessions(const std::vector<evaluation::PlannedRun>& plan,
                                                 const CollectArguments& arguments,
                                                 const std::atomic<bool>& stop) {
  constexpr double kLongest = 86400.0;  // of one session, wall time [s]
  evaluation::ExecutorOptions options;
  options.results = fs::absolute(arguments.request.results);
  options.timeout = kLongest;
  BatchProgress progress(plan, arguments.engine.jobs);
  return executeOn(arguments.engine, plan, options, false, progress, stop);
}

/// How many of the sessions have their scene, and how much room these take.
void describeScenes(const std::vector<CollectRequest>& sessions) {
  std::size_t count = 0;
  double bytes = 0.0;
  for (const CollectRequest& request : sessions) {
    const std::string name = collection::sessionName(collection::resolveCollection(request));
    const fs::path file = collection::sceneFile(request, name);
    std::error_code absent;
    const auto size = fs::file_size(file, absent);
    if (absent) continue;
    ++count;
    bytes += static_cast<double>(size);
  }
  std::cerr << count << " scenes, " << core::formatFixed(1e-6 * bytes, 1) << " MB\n";
}

/// Sums up every session whose files are there, and says so on standard error; `code`: how the
/// driving ended. Gives the exit code.
int conclude(const CollectArguments& arguments, const std::vector<CollectRequest>& sessions,
             int code) {
  if (arguments.request.scenes) describeScenes(sessions);
  if (!arguments.request.images) return code;
  collection::StatisticsByName statistics;
  for (const CollectRequest& request : sessions) {
    const std::string name = collection::sessionName(collection::resolveCollection(request));
    const fs::path file = collection::statisticsFile(request, name);
    if (fs::exists(file)) statistics[name] = collection::readStatistics(file);
  }
  collection::describeDataset(arguments.request.results, collection::sumOf(statistics));
  if (code == ExitCode::kPassed)
    collection::requireSamples(statistics, "session", "longer sessions (--duration)");
  return code;
}

/// A data set and a batch would mix the records of their runs.
void requireDatasetFolder(const fs::path& folder) {
  for (const char* name : {"matrix.yaml", "session.yaml", "search.yaml", "realism.json"}) {
    if (!core::isFile(folder / name)) continue;
    throw core::InputError("'" + folder.string() + "' holds results, see " + name +
                           "; give another --results");
  }
}

int collect(const CollectArguments& arguments) {
  if (!arguments.bags.bags.empty()) return convertBags(arguments);
  if (arguments.cancel) {
    cancelEngine(arguments.request.results);
    return ExitCode::kPassed;
  }
  requireEngine(arguments.engine);
  requireDatasetFolder(arguments.request.results);
  const std::vector<CollectRequest> sessions = planSessions(arguments);
  core::temporaryFolder();  // without one each session would fail
  const core::OutputFolder output(arguments.request.results, kLockedBy);
  if (arguments.request.images) core::OutputFolder::requireFree(output.path(), kDatasetFiles);
  requireNoWorker(fs::absolute(arguments.request.results));
  const auto plan = planOf(sessions);
  removeHalves(arguments.request.results);
  const std::atomic<bool>& stop = core::catchStopSignals();
  const auto records = driveSessions(plan, arguments, stop);
  output.requireInPlace();
  if (arguments.engine.prints()) return ExitCode::kPassed;
  return conclude(arguments, sessions, stop ? ExitCode::kInterrupted : exitCode(records));
}

/// Throws InputError where the session is not the one whose resolved scenario `planned` holds.
void requirePlanned(const CollectRequest& request, const std::string& planned) {
  const auto settings = collection::resolveCollection(request);
  if (core::dumpOptions(settings.scenario) == core::readFile(planned, "scenario")) return;
  throw core::InputError("scenario '" + request.scenario + "' has changed since '" + planned +
                         "' was planned; collect again");
}

void addCommonOptions(CLI::App& command, CollectRequest& request) {
  command.add_option("--results", request.results, "Folder of the data set")->required();
  command.add_option("--duration", request.duration, "Longest session [s]")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 3600.0));
  command.add_flag("--keep-bags", request.keep_bag, "Keep the bags that the shards are made of");
  command.add_flag("--scenes", request.scenes,
                   "Store each session as a scene: all but its images, which it gives again");
  command.add_flag("!--no-images", request.images,
                   "Render no images and make no shards: scenes, or bags where no scenes are asked "
                   "for");
  command
      .add_option("--set", request.set,
                  "Any key of the scenario or of the group collection as key=value")
      ->allow_extra_args(false);
}

/// Bags are converted as they are: what says how to drive is refused beside them.
void addBagOptions(CLI::App& command, node_graph::BagRequest& request) {
  CLI::Option* bags =
      command.add_option("--bags", request.bags, "Instead of driving: bags of a vehicle of yours")
          ->delimiter(',');
  command
      .add_option("--topics", request.topics,
                  "YAML file that names the bags' topics: image, odometry, control, path")
      ->needs(bags);
  for (const char* name :
       {"--scenarios", "--suite", "--seeds", "--first-seed", "--jobs", "--engine", "--slurm",
        "--cancel", "--duration", "--keep-bags", "--no-images", "--scenes", "--set"})
    bags->excludes(command.get_option(name));
}

}  // namespace

void addCollectCommand(CLI::App& program, int& exit_code) {
  auto arguments = std::make_shared<CollectArguments>();
  arguments->engine.command = "cdiff collect";
  arguments->engine.go_on = "to go on once they have ended: the same command";
  arguments->engine.again = "with the same command";
  arguments->engine.fresh = true;
  CLI::App* command = program.add_subcommand(
      "collect", "Drive and record many vehicles, and make training samples of it");
  command
      ->add_option("--scenarios", arguments->scenarios,
                   "Scenarios, names or files (default: all that are shipped)")
      ->delimiter(',');
  command->add_option("--suite", arguments->suite, "Route suite, name or folder: its scenarios");
  command->add_option("--seeds", arguments->seeds, "Sessions a scenario")
      ->capture_default_str()
      ->check(CLI::Range(1, 100000));
  command->add_option("--first-seed", arguments->first_seed, "Seed of the first of them")
      ->capture_default_str()
      ->check(CLI::Range(0, 1000000000));
  addEngineOptions(*command, arguments->engine);
  command->add_flag("--cancel", arguments->cancel,
                    "End the jobs of a data set on Slurm; the same command goes on with it");
  addCommonOptions(*command, arguments->request);
  addBagOptions(*command, arguments->bags);
  command->callback([arguments, &exit_code] { exit_code = collect(*arguments); });

  auto request = std::make_shared<CollectRequest>();
  CLI::App* session = program.add_subcommand(kSessionCommand, "One session of collect");
  session->group("");  // not shown: collect starts it
  session->add_option("scenario", request->scenario)->required();
  session->add_option("--seed", request->seed)->required();
  auto planned = std::make_shared<std::string>();
  session->add_option("--planned", *planned)->required();
  addCommonOptions(*session, *request);
  session->callback([request, planned, &exit_code] {
    requirePlanned(*request, *planned);
    node_graph::collectSession(*request, core::catchStopSignals());
    exit_code = ExitCode::kPassed;
  });
}

}  // namespace cdiff::cli
