// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace cdiff::cli {

/// One line for arguments that `program`, called `name`, refused when it parsed them: what is
/// wrong, the nearest option of the command in question, and how to see all.
std::string refusalText(const CLI::App& program, const std::string& name,
                        const CLI::ParseError& error);

/// Names of the commands of a program that its help lists.
std::vector<std::string> shownCommands(const CLI::App& program);

}  // namespace cdiff::cli
