// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace cdiff::ros {

// The other nodes of a session as processes: those that the same roslaunch has started on this
// machine, and the command line it was given. Read from /proc; where a node was started otherwise
// (rosrun, another machine) there is nothing to find.

/// The process of a node (name without namespace) that the parent of this process has started for
/// the same ROS master and namespace; nothing when there is none or it has ended.
std::optional<pid_t> launchedProcess(const std::string& node);

/// Ends that process with SIGKILL, the only signal that ends a stopped one. Returns whether there
/// was one.
bool killLaunchedProcess(const std::string& node);

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

/// Throws InputError for an argument on that command line that its launch file does not declare:
/// roslaunch itself ignores it and runs another session than the user meant.
void requireKnownLaunchArguments();

}  // namespace cdiff::ros
