// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The command `cdiff replay`: a session's result again from its bag alone.
#include <iostream>
#include <memory>

#include "cli/commands.h"
#include "core/markup.h"
#include "core/program.h"
#include "node_graph/bags/replay.h"

namespace cdiff::cli {
namespace {

struct ReplayArguments {
  std::string bag;
  std::string results;
  bool quiet = false;
  bool overwrite = false;
};

int replay(const ReplayArguments& arguments) {
  core::catchStopSignals();
  const node_graph::ReplayResult result =
      node_graph::replayBag(arguments.bag, arguments.results, arguments.overwrite);
  for (const std::string& finding : result.findings)
    std::cerr << "cdiff: bag '" << arguments.bag << "': " << core::plainText(finding) << "\n";
  if (!result.findings.empty())
    std::cerr << "cdiff: the recording is damaged; the result uses what could be read\n";
  if (!result.video_error.empty())
    std::cerr << "cdiff: " << core::plainText(result.video_error)
              << "; the other results are not affected\n";
  if (!result.failure.empty()) std::cerr << "cdiff: " << core::plainText(result.failure) << "\n";
  if (!arguments.quiet) std::cout << result.table << std::flush;
  return result.exit_code;
}

}  // namespace

void addReplayCommand(CLI::App& program, int& exit_code) {
  auto arguments = std::make_shared<ReplayArguments>();
  CLI::App* command =
      program.add_subcommand("replay", "Compute a session's result again from its bag alone");
  command->add_option("bag", arguments->bag, "session.bag, also one whose recording was cut off")
      ->required();
  command->add_option("--results", arguments->results, "Result folder")->required();
  command->add_flag("--overwrite", arguments->overwrite,
                    "Replace what an earlier session left in the result folder");
  command->add_flag("--quiet", arguments->quiet, "No table");
  command->callback([arguments, &exit_code] { exit_code = replay(*arguments); });
}

}  // namespace cdiff::cli
