// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <iostream>

#include "core/failure.h"
#include "core/program.h"
#include "training/command_line.h"

namespace {

enum ExitCode : int { kPassed = 0, kBadInput = 3 };

constexpr const char* kCommand = "cdiff train";  // which starts this program
constexpr std::size_t kNameColumn = 40;          // of --help, wide enough for names and defaults

}  // namespace

int main(int argc, char** argv) {
  cdiff::core::prepareProgram();
  CLI::App program{"Train the diffusion planner on collected shards", kCommand};
  cdiff::training::TrainingOptions options;
  program.get_formatter()->column_width(kNameColumn);
  cdiff::training::addOptions(program, options);
  for (const char* name : {"--data", "--output"}) program.get_option(name)->required();
  try {
    program.parse(argc, argv);
    cdiff::training::train(options, cdiff::core::catchStopSignals(), std::cout);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? kPassed : kBadInput;
  } catch (const std::exception& error) {
    const cdiff::core::Failure failure = cdiff::core::failureOf(error);
    std::cerr << kCommand << ": " << failure.text << "\n";
    return failure.exit_code;
  }
  return kPassed;
}
