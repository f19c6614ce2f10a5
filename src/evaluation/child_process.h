// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A program in a process group of its own that dies with us: started, polled, and killed with all
/// that it started.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace cdiff::evaluation {

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

}  // namespace cdiff::evaluation
