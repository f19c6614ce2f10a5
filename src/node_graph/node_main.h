// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <functional>
#include <string>

namespace cdiff::node_graph {

// The main functions of the nodes: signals, ROS under the node's default name, plug-ins, the node,
// and errors as one line and an exit code (as `cdiff`: 2 run time, 3 bad input). Free of ROS's
// headers, which would take most of the time of compiling each node.

/// Owns a session's world and clock.
int runTrafficSimulatorNode(int argc, char** argv);
/// Finds the critical background vehicles of a session.
int runCbvIdentificationNode(int argc, char** argv);
/// Renders what the driven vehicles see.
int runCameraNode(int argc, char** argv);
/// Drives the ego.
int runEgoPlannerNode(int argc, char** argv);
/// Drives all CBVs.
int runCbvPlannerNode(int argc, char** argv);
/// cbv_planner_node under the name that it has where the CBVs' planner sees.
int runDiffusionPlannerNode(int argc, char** argv);
/// Measures a session and writes its result folder.
int runMetricsNode(int argc, char** argv);
/// Records a session as a bag.
int runRecorderNode(int argc, char** argv);
/// Replays a recorded session under the traffic simulator's name, to which the other nodes listen.
int runReplayNode(int argc, char** argv);
/// Runs a session that CARLA simulates.
int runCarlaSessionNode(int argc, char** argv);
/// Makes markers of what rosbag play publishes.
int runSceneNode(int argc, char** argv);

class StopSignal;

/// Runs a node of a session in this thread, beside others of the same process, and returns its exit
/// code. `kind` is its name without namespace ("metrics_node"), `name` the full one. Throws
/// std::logic_error for a kind that there is not.
int runHostedNode(const std::string& kind, const std::string& name, StopSignal& stop);

/// Loads a nodelet of a kind ("metrics") under a full name; returns whether it could.
using LoadNodelet = std::function<bool(const std::string& kind, const std::string& name)>;
/// The main function of a process that hosts all nodes of a session: loads the kinds that its
/// arguments name, waits until they have left, and ends with the simulator's exit code.
int runNodeletManager(int argc, char** argv, const LoadNodelet& load);

/// Whether the ROS master answers within two seconds.
bool masterAnswers();

/// The fault of a session whose master does not.
inline constexpr const char* kNoMaster = "the ROS master does not answer any more";

}  // namespace cdiff::node_graph
