// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "session/session_request.h"

namespace cdiff::node_graph {

/// A node's private parameters as texts, through one gate: a parameter that the node does not know
/// is an error, and an empty text means "not given".
class Parameters {
 public:
  explicit Parameters(std::map<std::string, std::string> values) : values_(std::move(values)) {}
  /// The private parameters of this node. Throws InputError for a parameter that is neither text,
  /// number nor flag.
  static Parameters ofThisNode();
  /// Those of another node (name without namespace); none when it has none or the ROS master does
  /// not answer.
  static Parameters ofNode(const std::string& node);
  bool empty() const { return values_.empty(); }

  /// Throws InputError naming the unknown parameter and the nearest known one.
  void requireKnown(const std::vector<std::string>& known) const;
  /// Value, or empty when not given.
  std::string text(const std::string& key) const;
  /// Throws InputError when the value is not a number above zero.
  double positive(const std::string& key, double otherwise) const;
  /// Throws InputError when the value is neither true nor false.
  bool flag(const std::string& key, bool otherwise) const;

 private:
  static Parameters of(const std::string& full_name);

  std::map<std::string, std::string> values_;
};

/// Notes on the parameter server that this node has refused the input of its roslaunch, and said
/// why.
void noteRefusal();
/// Whether a node of the same roslaunch has left such a note; removes it.
bool takeRefusal();

/// The arguments of the roslaunch that started this process, which are the simulator's parameters;
/// none where it was started otherwise or by a launch file of the user.
Parameters launchParameters();

/// The session that the parameters scenario, bench2drive, route, network, mode, ego_planner,
/// cbv_planner, seed and set ask for; crossing_left_turn when they name none.
session::SessionRequest sessionRequest(const Parameters& parameters);

/// That session's scenario, resolved. Throws InputError as session::resolveRequest does, and for a
/// route of a sealed suite, which `cdiff evaluate --open-sealed` alone may run.
session::ScenarioOptions requestedScenario(const Parameters& parameters);

// Where a session of the node graph puts its files, and the result folder that the traffic
// simulator writes when the metrics node cannot: a session always leaves a result that can be read.

/// "roslaunch", as results name this deployment.
inline constexpr const char* kDeployment = "roslaunch";

/// Absolute result folder: the one given, else HOME/e2e_cdiff_results/SCENARIO_seedN_TIME.
std::filesystem::path resultFolder(const std::string& given,
                                   const session::ScenarioOptions& options);

/// Names a file in the environment that gets the exit code too (scripts/session reads it).
inline constexpr const char* kExitCodeVariable = "E2E_CDIFF_EXIT_CODE_FILE";

/// Writes the session's exit code (as `cdiff`'s) to the file exit_code, because roslaunch itself
/// exits with 0 whatever happened.
void writeExitCode(const std::filesystem::path& folder, int exit_code);

/// The exit code of a session that bad input kept from starting; a folder in use, or with an
/// earlier result, is not touched. `folder` may be empty.
void writeRefusal(const std::filesystem::path& folder);

/// Relative paths in parameters are meant from where the user started the session; empty: from
/// here. Throws InputError when there is no such folder.
void enterFolder(const std::string& folder);

/// Writes the result of a session that ended before its first snapshot, which its simulator was to
/// run with these parameters, and returns the exit code of `cdiff`. A result (file exit_code) that
/// this launch has already written stays, unless the session was interrupted. Bad input is reported
/// in one line, with exit code 3.
int writeUnstartedResult(const Parameters& parameters, traffic::SessionStatus status,
                         const traffic::Fault& fault);

}  // namespace cdiff::node_graph
