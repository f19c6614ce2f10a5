// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/guarded_process.h"

namespace cdiff::test {

/// A program that a test runs; what it prints is in the file `output`, which is created.
class ProgramRun : public core::GuardedProcess {
 public:
  ProgramRun(const std::filesystem::path& program, const std::vector<std::string>& arguments,
             const std::filesystem::path& output)
      : GuardedProcess(program, arguments, {}, {output, -1, -1, false}) {}

  /// Waits for its end; its exit code, or 128 + the signal that ended it.
  int wait() {
    constexpr double kLongest = 3600.0;  // [s]
    waitForEnd(kLongest);
    return exitCode();
  }
};

}  // namespace cdiff::test
