// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "commands.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/file.h"
#include "e2e_cdiff/core/text.h"
#include "e2e_cdiff/map/route_source.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;
using core::InputError;
using nlohmann::json;

struct EvaluateArguments {
  std::string bench2drive;
  std::string networks;
  std::string results;
  std::vector<std::string> routes;
  std::vector<std::string> set;
  int jobs = 1;
};

/// One planned session.
struct Run {
  std::string route;
  std::string town;
  fs::path network;
  fs::path folder;
  pid_t process = 0;
  int exit_code = -1;
};

/// A route that was asked for by its id must be there, with its network; of all routes of a file
/// those without are left out.
std::vector<Run> planRuns(const EvaluateArguments& arguments) {
  std::vector<Run> runs;
  std::vector<std::string> missing = arguments.routes;
  for (const map::Bench2DriveEntry& entry : map::listBench2DriveRoutes(arguments.bench2drive)) {
    const auto& wanted = arguments.routes;
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), entry.id) == wanted.end())
      continue;
    const fs::path network = fs::path(arguments.networks) / (entry.town + ".net.xml");
    if (!fs::exists(network)) continue;
    missing.erase(std::remove(missing.begin(), missing.end(), entry.id), missing.end());
    runs.push_back(
        {entry.id, entry.town, network, fs::path(arguments.results) / "runs" / entry.id});
  }
  if (!missing.empty()) {
    throw InputError("routes " + core::joinText(missing, ", ") + " are not in '" +
                     arguments.bench2drive + "', or the network of their town is not in '" +
                     arguments.networks + "'");
  }
  if (runs.empty()) {
    throw InputError("no route of '" + arguments.bench2drive +
                     "' lies in a town whose TOWN.net.xml is in '" + arguments.networks + "'");
  }
  return runs;
}

// A signal handler can reach nothing else.
std::atomic<bool> stop_requested{false};

void requestStop(int) { stop_requested = true; }

void catchSignals() {
  struct sigaction action {};
  action.sa_handler = requestStop;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

void start(Run& run, const EvaluateArguments& arguments) {
  std::vector<std::string> words = {"cdiff",
                                    "run",
                                    "--quiet",
                                    "--bench2drive",
                                    arguments.bench2drive,
                                    "--route",
                                    run.route,
                                    "--network",
                                    run.network.string(),
                                    "--results",
                                    run.folder.string()};
  for (const std::string& assignment : arguments.set) {
    words.push_back("--set");
    words.push_back(assignment);
  }
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  fs::create_directories(run.folder);
  fs::remove(run.folder / "summary.json");
  const int failed =
      posix_spawn(&run.process, "/proc/self/exe", nullptr, nullptr, argv.data(), environ);
  if (failed != 0)
    throw core::SimulatorError("cannot start a run: " + std::string(std::strerror(failed)));
}

void waitForOne(std::vector<Run>& runs, std::size_t& done) {
  int status = 0;
  const pid_t process = ::waitpid(-1, &status, 0);
  if (process < 0) return;  // a signal
  for (Run& run : runs) {
    if (run.process != process) continue;
    run.process = 0;
    run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    ++done;
    std::cerr << done << "/" << runs.size() << " route " << run.route << " exit code "
              << run.exit_code << "\n";
  }
}

/// Asks every run that is under way to end.
void interruptRuns(const std::vector<Run>& runs) {
  for (const Run& run : runs) {
    if (run.process > 0) ::kill(run.process, SIGINT);
  }
}

void execute(std::vector<Run>& runs, const EvaluateArguments& arguments) {
  std::size_t next = 0;
  std::size_t done = 0;
  catchSignals();
  while (done < (stop_requested ? next : runs.size())) {
    const auto running = static_cast<int>(next - done);
    if (stop_requested) interruptRuns(runs);
    if (!stop_requested && next < runs.size() && running < arguments.jobs) {
      start(runs[next++], arguments);
    } else {
      waitForOne(runs, done);
    }
  }
}

/// One line of the table.
struct Row {
  std::string status = "error";
  std::string completion = "-";
  std::string count = "0";
  int decisions = 0;
  int longest = 0;  ///< most decisions that a single CBV was driven
  int longest_at_junction =
      0;  ///< the same of CBVs whose conflict point lies at or beyond a junction
  std::string conflict = "-";
  std::string contacts = "-";
  std::string off_road = "-";
  std::string rejected;
};

std::string rejections(const json& rejected) {
  std::vector<std::pair<int, std::string>> reasons;
  for (const auto& [reason, count] : rejected.items())
    reasons.emplace_back(-count.get<int>(), reason);
  std::sort(reasons.begin(), reasons.end());
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < std::min<std::size_t>(3, reasons.size()); ++i) {
    texts.push_back(reasons[i].second + " " + std::to_string(-reasons[i].first));
  }
  return core::joinText(texts, ", ");
}

Row readRow(const Run& run) {
  Row row;
  const fs::path file = run.folder / "summary.json";
  if (!fs::exists(file)) return row;
  const json summary = json::parse(core::readFile(file, "summary"));
  row.status = summary.at("status");
  row.completion = core::formatFixed(summary.at("ego").at("route_completion_percent"), 1);
  row.contacts = std::to_string(summary.at("ego").at("collisions").get<int>());
  const json& cbv = summary.at("cbv");
  row.count = std::to_string(cbv.at("count").get<int>());
  row.decisions = cbv.at("decisions");
  const json& off_road = cbv.at("off_road_rate_percent");
  if (off_road.is_number()) row.off_road = core::formatFixed(off_road, 2);
  row.rejected = rejections(cbv.at("rejected"));
  for (const json& selection : cbv.at("selections")) {
    const json& point = selection.at("conflict_point");
    const int driven = selection.at("decisions_driven");
    row.longest = std::max(row.longest, driven);
    if (point.at("in_junction_or_beyond").get<bool>()) {
      row.longest_at_junction = std::max(row.longest_at_junction, driven);
    }
    if (row.conflict == "-") {
      row.conflict =
          core::formatFixed(point.at("x"), 1) + ", " + core::formatFixed(point.at("y"), 1);
    }
  }
  return row;
}

std::string tableLine(const Run& run, const Row& row) {
  return "| " + run.route + " | " + run.town + " | " + row.status + " | " + row.completion + " | " +
         row.contacts + " | " + row.count + " | " + std::to_string(row.decisions) + " | " +
         std::to_string(row.longest) + " | " + std::to_string(row.longest_at_junction) + " | " +
         row.off_road + " | " + row.conflict + " | " + row.rejected + " |\n";
}

std::string table(const std::vector<Run>& runs) {
  constexpr int kDriven = 30;  // decisions of one CBV that count as driven
  std::string text =
      "| route | town | status | RC % | ego contacts | CBVs | decisions | longest | longest with "
      "conflict at or beyond a junction | off-road % | first conflict point (x, y) | most frequent "
      "rejections |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  int errors = 0;
  int completed = 0;
  int driven = 0;
  int at_junction = 0;
  for (const Run& run : runs) {
    const Row row = readRow(run);
    errors += row.status == "error";
    completed += row.status == "completed";
    driven += row.longest >= kDriven;
    at_junction += row.longest_at_junction >= kDriven;
    text += tableLine(run, row);
  }
  return text + "\n" + std::to_string(runs.size()) + " routes: " + std::to_string(errors) +
         " errors, " + std::to_string(completed) + " completed; one CBV driven for at least " +
         std::to_string(kDriven) + " decisions on " + std::to_string(driven) +
         ", with a conflict point at or beyond a junction on " + std::to_string(at_junction) + "\n";
}

int evaluate(const EvaluateArguments& arguments) {
  std::vector<Run> runs = planRuns(arguments);
  execute(runs, arguments);
  const std::string text = table(runs);
  core::writeFileAtomically(fs::path(arguments.results) / "table.md", text);
  std::cout << text;
  const bool failed =
      std::any_of(runs.begin(), runs.end(), [](const Run& run) { return run.exit_code >= 2; });
  if (stop_requested) return kInterrupted;
  return failed ? kRunTimeError : kPassed;
}

}  // namespace

void addEvaluateCommand(CLI::App& program, int& exit_code) {
  auto arguments = std::make_shared<EvaluateArguments>();
  CLI::App* command = program.add_subcommand(
      "evaluate", "Run every Bench2Drive route whose town's network is at hand, and print a table");
  command->add_option("--bench2drive", arguments->bench2drive, "Bench2Drive route file")
      ->required();
  command->add_option("--networks", arguments->networks, "Folder with TOWN.net.xml files")
      ->required();
  command
      ->add_option("--results", arguments->results, "Result folder; one folder a run below runs/")
      ->required();
  command->add_option("--routes", arguments->routes, "Only these route ids")->delimiter(',');
  command
      ->add_option("--set", arguments->set, "Any key of the scenario as key=value; may be repeated")
      ->allow_extra_args(false);
  command->add_option("--jobs", arguments->jobs, "Sessions at a time")->check(CLI::Range(1, 64));
  command->callback([arguments, &exit_code] { exit_code = evaluate(*arguments); });
}

}  // namespace cdiff::cli
