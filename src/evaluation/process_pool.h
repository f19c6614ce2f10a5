// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A program started once for each of many jobs, a few at a time.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace cdiff::evaluation {

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
