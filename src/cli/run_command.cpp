// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <filesystem>
#include <memory>

#include "cli/commands.h"
#include "cli/run_session.h"
#include "core/text.h"
#include "session/session_request.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;

struct RunArguments {
  session::SessionRequest request;
  std::string results;
  bool quiet = false;
  bool record = false;
  bool overwrite = false;
};

int run(const RunArguments& arguments) {
  const session::ScenarioOptions options = session::resolveRequest(arguments.request);
  const fs::path folder =
      arguments.results.empty()
          ? fs::path("results") / (core::fileName(options.name) + "_seed" +
                                   std::to_string(options.seed) + "_" + core::timeForFileName())
          : fs::path(arguments.results);
  return runSession(options, {folder, arguments.quiet, arguments.record, arguments.overwrite});
}

}  // namespace

void addRunCommand(CLI::App& program, int& exit_code) {
  auto arguments = std::make_shared<RunArguments>();
  CLI::App* command = program.add_subcommand("run", "Run one session and write its result folder");
  session::SessionRequest& request = arguments->request;
  command->add_option("scenario", request.scenario, "Shipped scenario or scenario file");
  command->add_option("--bench2drive", request.bench2drive,
                      "Bench2Drive route file, instead of a scenario");
  command->add_option("--route", request.route, "Id of a route in that file");
  command->add_option("--network", request.network, "Network: shipped name, *.net.xml or *.xodr");
  command->add_option("--mode", request.mode, "naturalistic or safety_critical");
  command->add_option("--ego-planner", request.ego_planner, "Planner of the ego");
  command->add_option("--cbv-planner", request.cbv_planner, "Planner of the CBVs");
  command->add_option("--seed", request.seed, "Root seed");
  command->add_option("--set", request.set, "Any key of the scenario as key=value; may be repeated")
      ->allow_extra_args(false);
  command->add_option("--results", arguments->results,
                      "Result folder (default: results/SCENARIO_SEED_TIME)");
  command->add_flag("--overwrite", arguments->overwrite,
                    "Replace what an earlier session left in the result folder");
  command->add_flag("--record", arguments->record, "Also write session.bag, for replay and rviz");
  command->add_flag("--video", request.video, "Also write session.mp4: front view beside top view");
  command->add_flag("--quiet", arguments->quiet, "No progress line, no table");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace cdiff::cli
