// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The command `cdiff suite`: generates a suite of ego routes with their networks.
#include <iostream>
#include <map>
#include <memory>
#include <set>

#include "cli/commands.h"
#include "suite/suite_generator.h"

namespace cdiff::cli {
namespace {

struct SuiteArguments {
  std::string kind;
  std::string results;
  std::int64_t seed = 0;
};

/// How many routes there are of each maneuver at each level of traffic.
std::string countsTable(const suite::Suite& made) {
  std::map<std::string, std::map<std::string, int>> counts;
  std::set<std::string> networks;
  for (const suite::SuiteRoute& route : made.routes) {
    ++counts[route.manoeuvre][route.density];
    networks.insert(route.network);
  }
  std::string text = "| manoeuvre | low | medium | high |\n|---|---|---|---|\n";
  for (const std::string& manoeuvre : suite::manoeuvres()) {
    text += "| " + manoeuvre;
    for (const std::string& density : suite::densities())
      text += " | " + std::to_string(counts[manoeuvre][density]);
    text += " |\n";
  }
  return text + std::to_string(made.routes.size()) + " routes on " +
         std::to_string(networks.size()) + " networks\n";
}

}  // namespace

void addSuiteCommand(CLI::App& program, int& exit_code) {
  auto arguments = std::make_shared<SuiteArguments>();
  CLI::App* command =
      program.add_subcommand("suite", "Generate a suite of ego routes with their networks");
  command->add_option("kind", arguments->kind, "Which suite: train or development")
      ->required()
      ->check(CLI::IsMember(suite::suiteKinds()));
  command->add_option("--results", arguments->results, "Folder of the suite, new or empty")
      ->required();
  CLI::Option* seed = command->add_option("--seed", arguments->seed, "Root seed of all draws")
                          ->check(CLI::Range(0, 2147483647));
  command->callback([arguments, seed, &exit_code] {
    if (seed->count() == 0) arguments->seed = suite::defaultSeed(arguments->kind);
    std::cout << countsTable(
        suite::generateSuite(arguments->kind, arguments->seed, arguments->results));
    exit_code = ExitCode::kPassed;
  });
}

}  // namespace cdiff::cli
