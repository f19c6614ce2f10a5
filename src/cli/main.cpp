// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The program `cdiff`: its commands, and what it exits with.
#include <iostream>

#include "cli/commands.h"
#include "cli/plugin_guard.h"
#include "cli/refused_arguments.h"
#include "core/guarded_process.h"
#include "core/program.h"
#include "core/spelling.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/plan_file.h"
#include "plugins/plugin_loader.h"
#include "record/session_yaml.h"

namespace cdiff::cli {
namespace {

/// First line that `sumo --version` prints, e.g. "Eclipse SUMO sumo Version 1.15.0".
std::string sumoVersion() {
  constexpr double kPatience = 10.0;  // [s]
  const core::ProcessOutput output;
  try {
    core::GuardedProcess sumo(core::findProgram("sumo", "sumo"), {"--version"}, {},
                              {{}, -1, output.descriptor()});
    sumo.waitForEnd(kPatience, output);
  } catch (const core::Error&) {
    return {};
  }
  const std::string printed = output.end();
  const std::string text = printed.substr(0, printed.find('\n'));
  return text.substr(text.find_last_of(' ') + 1);
}

/// What `cdiff --version` prints: package version and revision, SUMO's version, and the instruction
/// sets that the program was compiled for and that its networks use on this machine; a line each.
std::string versionText() {
  const std::string sumo = sumoVersion();
  return "cdiff " + record::packageVersion() + "\nrevision " + record::packageRevision() +
         "\nSUMO " + (sumo.empty() ? "not found: install the package sumo" : sumo) +
         "\ninstruction set " + evaluation::instructionSets();
}

}  // namespace
}  // namespace cdiff::cli

namespace {

void addCommands(CLI::App& program, int& exit_code) {
  using namespace cdiff::cli;
  addRunCommand(program, exit_code);
  addDemoCommand(program, exit_code);
  addServeCommand(program, exit_code);
  addEvaluateCommand(program, exit_code);
  addExportCommand(program, exit_code);
  addNewCommand(program, exit_code);
  addValidateCommand(program, exit_code);
  addImportCommand(program, exit_code);
  addMetricCommand(program, exit_code);
  addTrainCommand(program, exit_code);
  addDoctorCommand(program, exit_code);
  addReportCommand(program, exit_code);
  addRealismCommand(program, exit_code);
  addSearchCommand(program, exit_code);
  addSuiteCommand(program, exit_code);
  addSteeringCommand(program, exit_code);
  addTuneCommand(program, exit_code);
  addWhatIfCommand(program, exit_code);
  addWorkerCommand(program, exit_code);
#ifdef E2E_CDIFF_WITH_ROS
  addReplayCommand(program, exit_code);
  addCollectCommand(program, exit_code);
#endif
}

/// CLI11 only says that some command is required.
void requireKnownCommand(const CLI::App& program, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return;
  const std::string given = argv[1];
  for (const CLI::App* command : program.get_subcommands({})) {
    if (command->get_name() == given) return;
  }
  const std::vector<std::string> known = cdiff::cli::shownCommands(program);
  throw cdiff::core::InputError("unknown command '" + cdiff::core::shortened(given) + "'" +
                                cdiff::core::didYouMean(given, known) +
                                "; known: " + cdiff::core::joinText(known, ", "));
}

/// Every command but these knows the planners, objectives and metrics of plug-ins; `doctor` says
/// what is wrong with them. Whether there are any.
bool loadPluginsFor(int argc, char** argv) {
  const std::string first = argc < 2 ? "" : argv[1];
  if (first == "doctor" || first.empty() || first.front() == '-') return false;
  return !cdiff::plugins::loadPlugins().empty();
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
  const auto command = [&] {
    try {
      program.parse(argc, argv);
      return exit_code;
    } catch (const CLI::ParseError& error) {
      if (error.get_exit_code() == 0) return program.exit(error);
      throw cdiff::core::InputError(cdiff::cli::refusalText(program, "cdiff", error));
    }
  };
  return cdiff::core::reportFailure([&] {
    requireKnownCommand(program, argc, argv);
    return loadPluginsFor(argc, argv) ? cdiff::cli::runBesidePlugins(command) : command();
  });
}
