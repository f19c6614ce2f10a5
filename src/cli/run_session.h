// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>

#include "session/scenario_options.h"

namespace cdiff::cli {

// One session in this process: closed loop, result folder, progress, and what a signal or a lost
// simulator does to them.

/// Where the results go, and how much is printed.
struct RunOutput {
  std::filesystem::path folder;
  bool quiet = false;      ///< no progress line, no table
  bool record = false;     ///< also write session.bag; InputError where built without ROS
  bool overwrite = false;  ///< what an earlier session left in the folder is removed
};

/// Runs to the end and answers the exit code. SIGINT, SIGTERM and SIGHUP end the session as
/// interrupted. Throws InputError for a scenario that cannot be set up or that SUMO refuses, and
/// for a folder that is in use or holds an earlier result (nothing in it is touched then); a
/// simulator that cannot start or is lost gives a result folder with status error.
int runSession(const session::ScenarioOptions& options, const RunOutput& output);

}  // namespace cdiff::cli
