// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A test that runs the program `cdiff` and reads what it says.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/file.h"
#include "support/program_run.h"
#include "support/temporary_folder.h"

namespace cdiff::test {

class CdiffCommand : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (scratch_.path() / name).string(); }
  /// Runs cdiff; its output is in expectOutput() afterward.
  int cdiff(const std::vector<std::string>& arguments) const {
    return run(CDIFF_PROGRAM, arguments);
  }
  int run(const std::string& program, const std::vector<std::string>& arguments) const {
    return ProgramRun(program, arguments, scratch_.path() / "output").wait();
  }
  std::string output() const { return core::readFile(scratch_.path() / "output", "output"); }
  void expectOutput(const std::string& part) const {
    EXPECT_NE(output().find(part), std::string::npos) << part << "\nin\n" << output();
  }
  TemporaryFolder scratch_;
};

}  // namespace cdiff::test
