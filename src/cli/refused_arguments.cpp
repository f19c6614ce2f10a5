// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "cli/refused_arguments.h"

#include "core/spelling.h"
#include "core/text.h"

namespace cdiff::cli {
namespace {

/// Names with which options are given ("--seed", "-h").
std::vector<std::string> optionNames(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

}  // namespace

std::vector<std::string> shownCommands(const CLI::App& program) {
  std::vector<std::string> names;
  for (const CLI::App* command : program.get_subcommands({})) {
    if (!command->get_group().empty()) names.push_back(command->get_name());
  }
  return names;
}

std::string refusalText(const CLI::App& program, const std::string& name,
                        const CLI::ParseError& error) {
  const CLI::App* command = &program;
  std::string words = name;
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().front();
    words += " " + command->get_name();
  }
  std::string text = error.what();
  const std::vector<std::string> left = command->remaining();
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr && !left.empty()) {
    const std::string option = left.front().substr(0, left.front().find('='));
    text = "'" + words + "' takes no argument '" + core::shortened(left.front()) + "'" +
           core::didYouMean(option, optionNames(*command));
  }
  return text + " (see " + words + " --help)";
}

}  // namespace cdiff::cli
