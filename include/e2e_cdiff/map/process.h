// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Runs a program as a child process, without a shell.
#pragma once

#include <string>
#include <vector>

namespace cdiff::map {

struct ProcessResult {
  int exit_code = 0;   ///< 128 + signal number when a signal ended it
  std::string output;  ///< standard output and standard error together
};

/// `arguments[0]` is looked up in PATH. SUMO_HOME is set to /usr/share/sumo when the environment
/// has none. Throws InputError when the program cannot be started.
ProcessResult runProcess(const std::vector<std::string>& arguments);

}  // namespace cdiff::map
