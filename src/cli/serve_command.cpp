// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The command `cdiff serve`: a server that starts once and runs many sessions for
/// `cdiff evaluate`.
#include <unistd.h>

#include <exception>

#include "cli/commands.h"
#include "core/kept_content.h"

namespace cdiff::cli {
namespace {

/// Networks, models and hashes at a time: a batch turns through its scenarios and planners.
constexpr std::size_t kKeptValues = 32;

/// What fails here fails in the child, whose log says so.
core::ForkedRun prepared(const std::vector<std::string>& words) {
  try {
    const core::ForkedRun run = prepareRun(words);
    return [run] { return core::reportFailure(run); };
  } catch (const std::exception&) {
    const std::exception_ptr error = std::current_exception();
    return [error] {
      return core::reportFailure([&error]() -> int { std::rethrow_exception(error); });
    };
  }
}

}  // namespace

void addServeCommand(CLI::App& program, int& exit_code) {
  CLI::App* command = program.add_subcommand("serve", "Run the sessions of cdiff evaluate");
  command->group("");
  command->callback([&exit_code] {
    core::keepContent(kKeptValues);
    exit_code = core::serveForks(STDIN_FILENO, prepared);
  });
}

}  // namespace cdiff::cli
