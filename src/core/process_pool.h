// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <atomic>
#include <cstddef>
#include <deque>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace cdiff::core {

// Many jobs, each a process of its own, a few at a time.

/// What one job runs.
struct ProcessJob {
  std::filesystem::path program;       ///< unused where a server runs it
  std::vector<std::string> arguments;  ///< without the program
  std::filesystem::path log = {};      ///< created; empty: output goes to our own streams
};

/// How a job's process ended.
struct ProcessEnd {
  std::size_t job = 0;
  int exit_code = -1;        ///< 128 + signal when killed
  double seconds = 0.0;      ///< wall time that it took [s]
  bool timed_out = false;    ///< killed because it took longer than PoolLimits::timeout
  bool interrupted = false;  ///< it ended after the pool was asked to stop
};

/// How many processes of a pool run at a time, and how long each may take.
struct PoolLimits {
  int at_a_time = 1;
  double timeout = std::numeric_limits<double>::infinity();  ///< of one process, wall time [s]
  double grace = std::numeric_limits<double>::infinity();    ///< time to end after a stop [s]
};

/// A program that runs jobs as a server (core/fork_server.h), and its arguments.
struct PoolServer {
  std::filesystem::path program;
  std::vector<std::string> arguments;
};

/// Callbacks of a pool.
struct PoolCalls {
  /// Called just before a job's process starts; returns what to run, or nothing where the job is
  /// not to be run any more.
  std::function<std::optional<ProcessJob>(std::size_t job)> start;
  /// Called when it has ended; returns whether to run the job again, before the others.
  std::function<bool(const ProcessEnd& end)> ended;
};

/// Runs the jobs in their order and returns when all have ended. Once `stop` is true no process is
/// started and those under way get SIGINT. With a server, as many of it run as jobs at a time, and
/// each job is a child of one; a server that has died is replaced. Throws SimulatorError when no
/// process can be made; those under way are killed then.
void runProcesses(std::deque<std::size_t> jobs, const PoolLimits& limits,
                  const std::atomic<bool>& stop, const PoolCalls& calls,
                  const std::optional<PoolServer>& server = {});

}  // namespace cdiff::core
