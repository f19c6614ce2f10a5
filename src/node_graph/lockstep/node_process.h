// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <sys/types.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "node_graph/lockstep/hosted_nodes.h"

namespace cdiff::node_graph {

// What a node knows of processes: its own stop signals and wall clock, and the nodes beside it.

/// SIGINT, SIGTERM and SIGHUP without a handler: they are blocked from here on, in every thread
/// made later, and asked for when it suits. So a session can end in order, whatever it is doing.
class StopSignal {
 public:
  /// Make it before any other thread exists, hence before ros::init.
  StopSignal();
  /// Whether one of them has arrived at the process, now or before, or raise() was called.
  bool raised();
  /// Stops who looks at this object, and no other node of the process.
  void raise() { raised_ = true; }

 private:
  std::atomic<bool> raised_{false};
};

// Wall-clock helpers of the traffic simulator's single thread.

/// [s] of wall time between looks at signals and limits.
constexpr double kSpinPeriod = 0.05;

inline double secondsSince(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Handles what has arrived at this node; waits at most `seconds` for it.
inline void spin(double seconds) { nodeQueue().callAvailable(ros::WallDuration(seconds)); }

// The other nodes of a session as processes: those that the same roslaunch has started on this
// machine, and the command line it was given. Read from /proc; where a node was started otherwise
// (rosrun, another machine) there is nothing to find.

/// The process of a node (name without namespace) that the parent of this process has started for
/// the same ROS master and namespace; nothing when there is none or it has ended.
std::optional<pid_t> launchedProcess(const std::string& node);

/// Ends that process with SIGKILL, the only signal that ends a stopped one. Returns whether there
/// was one.
bool killLaunchedProcess(const std::string& node);

/// Asks the roslaunch that started this process to end, as Ctrl-C does, and waits until it passes
/// the signal on (5 s at most): it calls the end of a required node red, however well it ended.
/// Does nothing where something else started this process.
void endLaunch(StopSignal& stop);

/// [s] since the epoch at which the parent of this process started.
std::optional<double> launchTime();

/// What roslaunch was requested to start.
struct LaunchCommand {
  std::filesystem::path file;                    ///< absolute
  std::filesystem::path folder;                  ///< where it runs
  std::map<std::string, std::string> arguments;  ///< NAME:=VALUE of the command line
};

/// The command line of the roslaunch that started this process, where it names one of this
/// package's own launch files and no other.
std::optional<LaunchCommand> launchCommand();

/// Throws InputError for an argument on that command line that roslaunch itself ignores, so that it
/// runs another session than the user meant: its launch file does not declare it, or its value
/// holds a line break or ":=".
void requireHeededLaunchArguments();

}  // namespace cdiff::node_graph
