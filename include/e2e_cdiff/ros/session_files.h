// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Where a session of the node graph puts its files, and the result folder that the traffic
/// simulator writes when the metrics node cannot: a session always leaves a result that can be
/// read.
#pragma once

#include <filesystem>
#include <string>

#include "e2e_cdiff/report/result_writer.h"

namespace cdiff::ros {

/// "roslaunch", as results name this deployment.
inline constexpr const char* kDeployment = "roslaunch";

/// Absolute result folder: the one given, else HOME/e2e_cdiff_results/SCENARIO_seedN_TIME. Makes
/// it, and takes away an earlier session's bag and exit code. Throws InputError when it cannot be
/// made.
std::filesystem::path makeResultFolder(const std::string& given,
                                       const scenario::ScenarioOptions& options);

/// Writes the session's exit code (as `cdiff`'s) to the file exit_code, because roslaunch itself
/// exits with 0 whatever happened.
void writeExitCode(const std::filesystem::path& folder, int exit_code);

/// Writes a result folder, and the exit code, from the last snapshot alone.
void writeResult(const scenario::SessionSetup& setup, const traffic::TrafficSnapshot& last,
                 const report::RunFacts& facts, const std::filesystem::path& folder,
                 double wall_seconds);

}  // namespace cdiff::ros
