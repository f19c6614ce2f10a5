// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <algorithm>
#include <iostream>

#include "cli/commands.h"
#include "cli/version.h"
#include "core/program.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "plugins/plugin_loader.h"

namespace {

void addCommands(CLI::App& program, int& exit_code) {
  using namespace cdiff::cli;
  addRunCommand(program, exit_code);
  addEvaluateCommand(program, exit_code);
  addValidateCommand(program, exit_code);
  addImportCommand(program, exit_code);
  addMetricCommand(program, exit_code);
  addTrainCommand(program, exit_code);
  addDoctorCommand(program, exit_code);
  addReportCommand(program, exit_code);
  addRealismCommand(program, exit_code);
  addSuiteCommand(program, exit_code);
#ifdef E2E_CDIFF_WITH_ROS
  addReplayCommand(program, exit_code);
  addCollectCommand(program, exit_code);
#endif
}

/// CLI11 only says that some command is required.
void requireKnownCommand(const CLI::App& program, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return;
  std::vector<std::string> known;
  for (const CLI::App* command : program.get_subcommands({})) known.push_back(command->get_name());
  const std::string given = argv[1];
  if (std::find(known.begin(), known.end(), given) != known.end()) return;
  throw cdiff::core::InputError("unknown command '" + cdiff::core::shortened(given) + "'" +
                                cdiff::core::didYouMean(given, known) +
                                "; known: " + cdiff::core::joinText(known, ", "));
}

/// Every command but these knows the planners, objectives and metrics of plug-ins; `doctor` says
/// what is wrong with them.
void loadPluginsFor(int argc, char** argv) {
  const std::string first = argc < 2 ? "" : argv[1];
  if (first != "doctor" && !first.empty() && first.front() != '-') cdiff::plugins::loadPlugins();
}

}  // namespace

int main(int argc, char** argv) {
  cdiff::core::prepareProgram();
  CLI::App program{"cdiff: closed-loop traffic scenarios without a ROS master"};
  program.require_subcommand(1);
  program.set_version_flag("--version", cdiff::cli::versionText,
                           "Print version, revision, SUMO's version and instruction sets");
  int exit_code = cdiff::cli::ExitCode::kPassed;
  addCommands(program, exit_code);
  try {
    requireKnownCommand(program, argc, argv);
    loadPluginsFor(argc, argv);
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? cdiff::cli::ExitCode::kPassed
                                    : cdiff::cli::ExitCode::kBadInput;
  } catch (const std::exception& error) {
    const cdiff::core::Failure failure = cdiff::core::failureOf(error);
    std::cerr << "cdiff: " << failure.text << "\n";
    return failure.exit_code;
  }
  return exit_code;
}
