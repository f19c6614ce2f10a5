// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A test that runs the program `cdiff` and reads what it says.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "core/file.h"
#include "evaluation/child_process.h"
#include "support/temporary_folder.h"

namespace cdiff::test {

class CdiffCommand : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (scratch_.path() / name).string(); }
  /// Runs cdiff; its output is in expectOutput() afterwards.
  int cdiff(const std::vector<std::string>& arguments) const {
    return run(CDIFF_PROGRAM, arguments);
  }
  int run(const std::string& program, const std::vector<std::string>& arguments) const {
    evaluation::ChildProcess process(program, arguments, scratch_.path() / "output");
    std::optional<int> exit_code = process.poll();
    while (!exit_code) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      exit_code = process.poll();
    }
    return *exit_code;
  }
  std::string output() const { return core::readFile(scratch_.path() / "output", "output"); }
  void expectOutput(const std::string& part) const {
    EXPECT_NE(output().find(part), std::string::npos) << part << "\nin\n" << output();
  }
  TemporaryFolder scratch_;
};

}  // namespace cdiff::test
