// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The command `cdiff steering`: what was steered in a session, as a scenario.
#include <iostream>
#include <memory>
#include <string>

#include "cli/commands.h"
#include "session/steering_file.h"

namespace cdiff::cli {

void addSteeringCommand(CLI::App& program, int& exit_code) {
  auto result = std::make_shared<std::string>();
  CLI::App* command = program.add_subcommand(
      "steering", "Print the scenario that repeats a session with what was steered in it");
  command->add_option("result", *result, "Result folder of the session")->required();
  command->callback([result, &exit_code] {
    std::cout << session::steeredScenario(*result);
    exit_code = ExitCode::kPassed;
  });
}

}  // namespace cdiff::cli
