// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <string>

#include "core/program.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "node_graph/parameters.h"

namespace cdiff::node_graph {

// Where a session of the node graph puts its files, and the result that is written when the metrics
// node cannot: a session always leaves one that can be read. Called by the nodes that begin a
// session (traffic simulator, replay, CARLA), by the metrics node, which ends it, and by the
// program that writes the result of a session that never began.

/// "roslaunch", as results name this deployment.
inline constexpr const char* kDeployment = "roslaunch";

/// What of plug-ins a node calls, or all of them in one process ("session_nodelets"), as the end of
/// a sentence about its end; empty where nothing.
std::string pluginsOf(const std::string& node, const session::ScenarioOptions& options);
/// Leaves the metrics of plug-ins out of the results of this process, and says so in them: one of
/// them may be why the metrics node did not finish.
void leaveOutPluginMetrics();

/// Absolute result folder: the one given, else HOME/e2e_cdiff_results/SCENARIO_seedN_TIME.
std::filesystem::path resultFolder(const std::string& given,
                                   const session::ScenarioOptions& options);

/// Names a file in the environment that gets the exit code too (scripts/session reads it).
inline constexpr const char* kExitCodeVariable = "E2E_CDIFF_EXIT_CODE_FILE";

/// Writes the session's exit code (as `cdiff`'s) to the file exit_code, because roslaunch itself
/// exits with 0 whatever happened.
void writeExitCode(const std::filesystem::path& folder, int exit_code);

/// The exit code of a session that bad input, or another error, kept from starting; a folder in
/// use, or with a result, is not touched. `folder` may be empty.
void writeRefusal(const std::filesystem::path& folder, int exit_code = core::ExitCode::kBadInput);

/// Relative paths in parameters are meant from where the user started the session; empty: from
/// here. Throws InputError when there is no such folder.
void enterFolder(const std::string& folder);

/// Writes the result of a session that its nodes left without one, which its simulator was to run
/// with these parameters, and returns the exit code of `cdiff`. It is made of the ticks that the
/// simulator kept, where its process died; else it has none. A result (file exit_code) that
/// this launch has already written stays, unless the session was interrupted. Loads plug-ins, so
/// this process must have one thread; their metrics are left out. Bad input is reported in one
/// line, with exit code 3.
int writeUnstartedResult(const Parameters& parameters, traffic::SessionStatus status,
                         const traffic::Fault& fault);

/// Notes on the parameter server that this node has refused the input of its roslaunch, and said
/// why.
void noteRefusal();
/// Whether a node of the same roslaunch has left such a note; removes it.
bool takeRefusal();

}  // namespace cdiff::node_graph
