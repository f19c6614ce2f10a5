// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The command `cdiff validate`: checks scenarios without running them.
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <vector>

#include "cli/commands.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "map/lane_graph.h"
#include "planners/registry.h"
#include "session/session_request.h"
#include "session/session_setup.h"

namespace cdiff::cli {
namespace {

/// Checks one scenario as far as it goes without starting SUMO; returns whether it is good.
bool validateOne(const std::string& scenario_name, bool print) {
  try {
    session::SessionRequest request;
    request.scenario = scenario_name;
    const session::ScenarioOptions options = session::resolveRequest(request);
    const session::SessionSetup setup(options);
    if (options.ego_planner != planning::kExternalPlanner) setup.makeEgoPlanner();
    setup.makeCbvPlanner();
    std::ostream& out = print ? std::cerr : std::cout;  // what is printed can be a scenario file
    out << scenario_name << ": valid (ego route " << static_cast<int>(setup.egoRoute().length())
        << " m)\n";
    const std::string turns = map::turnRoundText(setup.network());
    if (!turns.empty()) out << "  network: " << turns << "\n";
    for (const std::string& change : setup.import().changes) out << "  network: " << change << "\n";
    if (print) std::cout << core::dumpOptions(options, true);
    return true;
  } catch (const core::InputError& error) {
    const std::string text = error.what();
    const bool named = text.rfind(std::filesystem::absolute(scenario_name).string() + ":", 0) == 0;
    std::cerr << "cdiff: " << (named ? "" : scenario_name + ": ") << text << "\n";
    return false;
  }
}

/// A row per planner, for scenario files and for people who look for one.
void printPlanners() {
  std::cout << "planner          drives    cameras  guided  of\n";
  for (const planning::PlannerDescriptor* planner : planners::registeredPlanners()) {
    const std::string roles =
        std::string(planner->drives_ego ? "ego " : "") + (planner->drives_cbv ? "CBVs" : "");
    std::cout << std::left << std::setw(17) << planner->name << std::setw(10) << roles
              << std::setw(9) << (planner->sees() ? core::joinText(planner->cameras, ",") : "-")
              << std::setw(8) << (planner->guided ? "yes" : "no")
              << planners::sourceOf(planner->name) << "\n    " << planner->title << ": "
              << planner->help << "\n";
  }
  std::cout
      << std::left << std::setw(17) << planning::kExternalPlanner << std::setw(10) << "ego"
      << std::setw(9) << "-" << std::setw(8) << "no"
      << "this package\n"
      << "    a node of your own that publishes on the ego's control topic (roslaunch only)\n";
}

}  // namespace

void addValidateCommand(CLI::App& program, int& exit_code) {
  auto scenarios = std::make_shared<std::vector<std::string>>();
  auto print = std::make_shared<bool>(false);
  auto list = std::make_shared<bool>(false);
  CLI::App* command = program.add_subcommand("validate", "Check scenarios without running them");
  command->add_option("scenarios", *scenarios,
                      "Scenario files or names (default: all shipped ones)");
  command->add_flag("--print", *print, "Print all keys with their values, meaning and range");
  command->add_flag("--planners", *list, "List the planners that a scenario can name, and end");
  command->callback([scenarios, print, list, &exit_code] {
    if (*list) return printPlanners();
    const auto names = scenarios->empty() ? session::shippedScenarios() : *scenarios;
    for (const std::string& name : names) {
      if (!validateOne(name, *print)) exit_code = ExitCode::kBadInput;
    }
  });
}

}  // namespace cdiff::cli
