// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <string>
#include <vector>

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

/// The arguments of the roslaunch that started this process, which are the simulator's parameters;
/// none where it was started otherwise or by a launch file of the user.
Parameters launchParameters();

/// The session that the parameters scenario, bench2drive, route, network, mode, ego_planner,
/// cbv_planner, seed and set ask for; crossing_left_turn when they name none.
session::SessionRequest sessionRequest(const Parameters& parameters);

/// That session's scenario, resolved. Throws InputError as session::resolveRequest does, and for a
/// route of a sealed suite, which `cdiff evaluate --open-sealed` alone may run.
session::ScenarioOptions requestedScenario(const Parameters& parameters);

}  // namespace cdiff::node_graph
