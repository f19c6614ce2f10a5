// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <sys/types.h>

#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace cdiff::evaluation {

/// A program in a process group of its own that dies with us: started, polled, and killed with all
/// that it started.
class ChildProcess {
 public:
  /// Output and errors go to `log`, which is made anew, or where ours go if it is empty. Throws
  /// SimulatorError when no process can be made; a program that cannot be executed exits with 127.
  ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
               const std::filesystem::path& log);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Exit code, 128 + signal where one ended it; nullopt while it runs.
  std::optional<int> poll();
  /// Sends a signal to the group.
  void signal(int number) const;

 private:
  pid_t process_ = 0;
  std::optional<int> exit_code_;
};

// A program started once for each of many jobs, a few at a time.

struct ProcessJob {
  std::string name;                ///< for people
  std::vector<std::string> words;  ///< arguments, without the program
  int exit_code = -1;              ///< -1: not run; 128 + signal when killed
};

/// Runs all of them, `at_a_time` together, and calls `ended` after each. Once `stop` is true the
/// running ones get SIGINT and no more is started. Throws SimulatorError when no process can be
/// made.
void runProcesses(const std::filesystem::path& program, std::vector<ProcessJob>& jobs,
                  int at_a_time, const std::atomic<bool>& stop,
                  const std::function<void(const ProcessJob&)>& ended);

}  // namespace cdiff::evaluation
