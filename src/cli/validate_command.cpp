// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The command `cdiff validate`: checks scenarios without driving the ego.
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <vector>

#include "cli/commands.h"
#include "cli/scenario_keys.h"
#include "core/markup.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "map/lane_graph.h"
#include "planners/registry.h"
#include "session/scenario_review.h"
#include "session/session_control.h"
#include "session/session_request.h"
#include "session/session_setup.h"
#include "storyboard/scenario_reader.h"
#include "suite/seal.h"

namespace cdiff::cli {
namespace {

struct ValidateArguments {
  std::vector<std::string> scenarios;
  std::vector<std::string> set;  ///< "key=value" each
  bool print = false;
  std::string group;      ///< print this group alone
  bool fast = false;      ///< do not start SUMO
  bool list = false;      ///< list planners instead
  bool elements = false;  ///< list elements of OpenSCENARIO instead
};

/// What validate says about the traffic; adds to `warnings`. `reason` not to start SUMO, or empty.
std::string trafficText(const session::SessionSetup& setup, const std::string& reason,
                        std::vector<std::string>& warnings) {
  constexpr double kPatience = 10.0;  // [s]
  if (!reason.empty()) return "traffic not tried on SUMO (" + reason + ")";
  const session::TrafficTrial trial = session::tryTraffic(setup, kPatience);
  for (std::string& text : session::trialWarnings(setup.options(), trial))
    warnings.push_back(std::move(text));
  return "traffic tried on SUMO for " + core::formatFixed(trial.simulated, 0) + " s, at most " +
         std::to_string(trial.most) + " vehicles at a time";
}

void describeScenario(const session::SessionSetup& setup, const ValidateArguments& arguments,
                      bool sealed) {
  const session::ScenarioOptions& options = setup.options();
  std::vector<std::string> warnings = session::scenarioWarnings(setup);
  const std::string traffic =
      trafficText(setup, arguments.fast ? "--fast" : (sealed ? "sealed suite" : ""), warnings);
  std::ostream& out = arguments.print ? std::cerr : std::cout;  // printed: can be a scenario file
  out << options.name << ": valid (ego route " << static_cast<int>(setup.egoRoute().length())
      << " m; " << traffic << ")\n";
  const std::string turns = map::turnRoundText(setup.network());
  if (!turns.empty()) out << "  network: " << turns << "\n";
  for (const std::string& change : setup.import().changes) out << "  network: " << change << "\n";
  out << std::flush;
  for (const std::string& warning : warnings)
    std::cerr << "cdiff: warning: " << core::plainText(options.name + ": " + warning) << "\n";
}

/// Checks one scenario up to the session's start; returns whether it is good.
bool validateOne(const std::string& scenario_name, const ValidateArguments& arguments) {
  try {
    session::SessionRequest request;
    request.scenario = scenario_name;
    request.set = arguments.set;
    const session::ScenarioOptions options = session::resolveRequest(request);
    const session::SessionSetup setup(options);
    const session::SessionControl control(setup);
    if (options.ego_planner != planning::kExternalPlanner) setup.makeEgoPlanner();
    if (options.cbv_planner != planning::kExternalPlanner) setup.makeCbvPlanner();
    describeScenario(setup, arguments, suite::sealedSuiteOf(scenario_name).has_value());
    if (arguments.print) std::cout << scenarioKeys(options, arguments.group);
    return true;
  } catch (const core::InputError& error) {
    const std::string text = error.what();
    const bool named = text.rfind(std::filesystem::absolute(scenario_name).string() + ":", 0) == 0;
    std::cerr << "cdiff: " << core::plainText((named ? "" : scenario_name + ": ") + text) << "\n";
    return false;
  }
}

/// A row per planner, for scenario files and for people who look for one.
void printPlanners() {
  constexpr int kCameras = 30;
  std::cout << std::left << "planner          drives    " << std::setw(kCameras) << "cameras"
            << "guided  of\n";
  for (const planning::PlannerDescriptor* planner : planners::registeredPlanners()) {
    const std::string roles =
        std::string(planner->drives_ego ? "ego " : "") + (planner->drives_cbv ? "CBVs" : "");
    std::cout << std::left << std::setw(17) << planner->name << std::setw(10) << roles
              << std::setw(kCameras)
              << (planner->sees() ? core::joinText(planner->cameras, ",") : "-") << std::setw(8)
              << (planner->guided ? "yes" : "no") << planners::sourceOf(planner->name) << "\n    "
              << planner->title << ": " << planner->help << "\n";
  }
  std::cout << std::left << std::setw(17) << planning::kExternalPlanner << std::setw(10)
            << "ego CBVs" << std::setw(kCameras) << "-" << std::setw(8) << "no"
            << "this package\n"
            << "    a node of your own that publishes on the control topics (roslaunch only)\n";
}

}  // namespace

void addValidateCommand(CLI::App& program, int& exit_code) {
  auto arguments = std::make_shared<ValidateArguments>();
  CLI::App* command = program.add_subcommand(
      "validate", "Check scenarios up to the session's start, their traffic on SUMO included");
  command->add_option("scenarios", arguments->scenarios,
                      "Scenario files or names (default: all shipped ones)");
  command
      ->add_option("--set", arguments->set,
                   "Any key of the scenarios as key=value; may be repeated")
      ->allow_extra_args(false);
  command->add_flag("--print", arguments->print,
                    "Print all keys with their values, meaning and range; '# default' marks what "
                    "differs from it");
  command->add_option("--group", arguments->group, "Print this group alone");
  command->add_flag("--fast", arguments->fast, "Do not start SUMO to try the traffic");
  command->add_flag("--planners", arguments->list,
                    "List the planners that a scenario can name, and end");
  command->add_flag("--elements", arguments->elements,
                    "List the elements of OpenSCENARIO files that are read, and end");
  command->callback([arguments, &exit_code] {
    if (arguments->elements) {
      std::cout << storyboard::supportTable();
      return;
    }
    if (arguments->list) return printPlanners();
    if (!arguments->group.empty()) arguments->print = true;
    const auto names =
        arguments->scenarios.empty() ? session::shippedScenarios() : arguments->scenarios;
    for (const std::string& name : names) {
      if (!validateOne(name, *arguments)) exit_code = ExitCode::kBadInput;
    }
  });
}

}  // namespace cdiff::cli
