// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The program `cdiff_train`: trains one planner with libtorch (`cdiff train`).
#include <CLI/CLI.hpp>
#include <iostream>
#include <string>

#include "cli/refused_arguments.h"
#include "core/markup.h"
#include "core/program.h"
#include "learning/trainer.h"
#include "learning/training_options.h"
#include "planners/trainings.h"

namespace {

using cdiff::core::ExitCode;

constexpr const char* kCommand = "cdiff train";  // which starts this program
constexpr std::size_t kNameColumn = 40;          // of --help, wide enough for names and defaults

/// The value of --task, which decides what the other options are; empty: not given.
std::string taskNamed(int argc, char** argv) {
  const std::string name = "--task";
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == name && i + 1 < argc) return argv[i + 1];
    if (argument.rfind(name + "=", 0) == 0) return argument.substr(name.size() + 1);
  }
  return {};
}

int trainAsAsked(int argc, char** argv) {
  const cdiff::learning::TaskRegistry tasks = cdiff::planners::packageTrainings();
  cdiff::learning::Training training = tasks.training(taskNamed(argc, argv));
  CLI::App program{tasks.descriptor(training.options.task).help, kCommand};
  program.get_formatter()->column_width(kNameColumn);
  cdiff::learning::addOptions(program, training);
  program.get_option("--output")->required();
  program.get_option("--data")->required(training.needsSamples());
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return program.exit(error);
    std::cerr << kCommand << ": " << cdiff::cli::refusalText(program, kCommand, error) << "\n";
    return ExitCode::kBadInput;
  }
  cdiff::learning::train(training, cdiff::core::catchStopSignals(), std::cout);
  return ExitCode::kPassed;
}

}  // namespace

int main(int argc, char** argv) {
  cdiff::core::prepareProgram();
  try {
    return trainAsAsked(argc, argv);
  } catch (const std::exception& error) {
    const cdiff::core::Failure failure = cdiff::core::failureOf(error);
    std::cerr << kCommand << ": " << cdiff::core::plainText(failure.text) << "\n";
    return failure.exit_code;
  }
}
