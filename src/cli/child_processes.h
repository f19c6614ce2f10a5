// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// This program started again for each of many jobs, a few at a time.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace cdiff::cli {

struct ChildProcess {
  std::string name;                ///< for people
  std::vector<std::string> words;  ///< arguments, without the program
  int exit_code = -1;              ///< -1: not run; 128 + signal when killed
};

/// Runs all of them, `at_a_time` together, and calls `ended` after each. After SIGINT or SIGTERM
/// the running ones are asked to end and no more is started; answers false then.
bool runChildren(std::vector<ChildProcess>& children, int at_a_time,
                 const std::function<void(const ChildProcess&)>& ended);

}  // namespace cdiff::cli
