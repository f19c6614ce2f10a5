// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <csignal>
#include <iostream>

#include "commands.h"
#include "e2e_cdiff/core/exceptions.h"

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
  addSuiteCommand(program, exit_code);
#ifdef E2E_CDIFF_WITH_ROS
  addReplayCommand(program, exit_code);
#endif
#ifdef E2E_CDIFF_WITH_COLLECT
  addCollectCommand(program, exit_code);
#endif
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);
  CLI::App program{"cdiff: closed-loop traffic scenarios without a ROS master"};
  program.require_subcommand(1);
  int exit_code = cdiff::cli::kPassed;
  addCommands(program, exit_code);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? cdiff::cli::kPassed : cdiff::cli::kBadInput;
  } catch (const cdiff::core::InputError& error) {
    std::cerr << "cdiff: " << error.what() << "\n";
    return cdiff::cli::kBadInput;
  } catch (const cdiff::core::Interrupted& error) {
    std::cerr << "cdiff: " << error.what() << "\n";
    return cdiff::cli::kInterrupted;
  } catch (const std::exception& error) {
    std::cerr << "cdiff: " << error.what() << "\n";
    return cdiff::cli::kRunTimeError;
  }
  return exit_code;
}
