// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The command `cdiff train`: starts cdiff_train, a program of its own with libtorch.
#include <unistd.h>

#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "core/markup.h"
#include "core/process_pool.h"
#include "core/program.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;

/// The trainer is a program of its own, so that this one starts without libtorch.
fs::path findTrainer() {
  std::error_code error;
  const fs::path here = fs::read_symlink("/proc/self/exe", error).parent_path();
  const fs::path trainer = here / "cdiff_train";
  if (::access(trainer.c_str(), X_OK) == 0) return trainer;
  throw core::InputError(
      "no cdiff_train beside " + here.string() +
      ": the trainer is not built; run scripts/setup, or configure with E2E_CDIFF_TRAINING");
}

/// Runs to its end; a stop signal to us is one to it, which then leaves a checkpoint.
int runTrainer(const std::vector<std::string>& arguments) {
  const fs::path trainer = findTrainer();
  int exit_code = ExitCode::kInterrupted;  // if it is not even started
  core::PoolCalls calls;
  calls.start = [&](std::size_t) { return core::ProcessJob{trainer, arguments}; };
  calls.ended = [&](const core::ProcessEnd& end) {
    exit_code = end.exit_code;
    return false;
  };
  core::runProcesses({0}, {}, core::catchStopSignals(), calls);
  return exit_code;
}

/// Folder given as --output; empty if there is none.
fs::path outputOf(const std::vector<std::string>& arguments) {
  const std::string name = "--output";
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i] == name && i + 1 < arguments.size()) return arguments[i + 1];
    if (arguments[i].rfind(name + "=", 0) == 0) return arguments[i].substr(name.size() + 1);
  }
  return {};
}

int trainAndDraw(const std::vector<std::string>& arguments) {
  const int code = runTrainer(arguments);
  if (code == ExitCode::kBadInput) return code;  // the folder may be another training's
  const fs::path output = outputOf(arguments);
  if (output.empty() || !fs::exists(output / "curves.csv")) return code;
  try {
    const fs::path page = writeTrainingPage(output);
    std::cerr << "curves: " << page.string() << "\n";
  } catch (const core::Error& error) {
    std::cerr << "cdiff: the curves are not drawn: " << core::plainText(error.what()) << "\n";
  }
  return code;
}

}  // namespace

void addTrainCommand(CLI::App& program, int& exit_code) {
  CLI::App* command = program.add_subcommand(
      "train", "Train a learned planner ('cdiff train --help' lists the options)");
  command->set_help_flag();
  command->prefix_command();
  command->callback([command, &exit_code] { exit_code = trainAndDraw(command->remaining()); });
}

}  // namespace cdiff::cli
