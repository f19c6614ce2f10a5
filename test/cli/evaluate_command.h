// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Runs the program `cdiff` in a folder of its own.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "core/file.h"
#include "core/text.h"
#include "support/program_run.h"
#include "support/temporary_folder.h"

namespace cdiff::test {

class EvaluateCommand : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(scratch_.path() / name) << text;
    return (scratch_.path() / name).string();
  }
  std::string folder(const std::string& name) const { return (scratch_.path() / name).string(); }
  /// Runs cdiff; its output is in output() afterward.
  int cdiff(const std::vector<std::string>& arguments) const {
    return ProgramRun(CDIFF_PROGRAM, arguments, scratch_.path() / "output").wait();
  }
  std::string output() const { return core::readFile(scratch_.path() / "output", "output"); }
  void expectOutput(const std::string& part) const {
    EXPECT_NE(output().find(part), std::string::npos) << part << "\nin\n" << output();
  }
  static std::size_t lines(const std::filesystem::path& file) {
    return core::splitText(core::readFile(file, "file"), '\n').size();
  }
  TemporaryFolder scratch_;
};

}  // namespace cdiff::test
