// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "commands.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;

/// The trainer is a program of its own, so that this one starts without libtorch.
fs::path findTrainer() {
  std::error_code error;
  const fs::path here = fs::read_symlink("/proc/self/exe", error).parent_path();
  // Installed side by side; in a plain build folder each lies in the folder of its sources.
  for (const fs::path& place : {here / "cdiff_train", here / ".." / "training" / "cdiff_train"}) {
    if (::access(place.c_str(), X_OK) == 0) return place;
  }
  throw core::InputError("no cdiff_train beside " + here.string() +
                         ": this build is without the trainer (E2E_CDIFF_TRAINING)");
}

[[noreturn]] void becomeTrainer(std::vector<std::string> arguments) {
  std::string program = findTrainer().string();
  std::vector<char*> argv = {program.data()};
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  ::execv(program.c_str(), argv.data());
  throw core::SimulatorError("cannot start '" + program + "': " + std::strerror(errno));
}

}  // namespace

void addTrainCommand(CLI::App& program, int&) {
  CLI::App* command = program.add_subcommand(
      "train", "Train the diffusion planner (cdiff_train; 'cdiff train --help' lists its options)");
  command->set_help_flag();
  command->prefix_command();
  command->callback([command] { becomeTrainer(command->remaining()); });
}

}  // namespace cdiff::cli
