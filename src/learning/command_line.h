// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The options of an options struct on the command line: `--steps 10` for the key `steps`, a flag
/// for each key that is true or false, `--no-KEY` where it is true unless given.
#pragma once

#include <CLI/CLI.hpp>

#include "learning/training_options.h"

namespace cdiff::learning {

/// Adds an option for each field, with its meaning, unit, choices and default. What is given goes
/// into `training`, which must outlive `program`; a value that is refused throws InputError naming
/// option and range when the program parses.
void addOptions(CLI::App& program, Training& training);

}  // namespace cdiff::learning
