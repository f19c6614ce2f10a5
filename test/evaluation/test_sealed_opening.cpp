// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <filesystem>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/suite_selection.h"
#include "suite/suite.h"
#include "support/temporary_folder.h"

namespace cdiff::evaluation {
namespace {

// No session is planned here, so that no sealed suite is opened.

MatrixOptions matrixOn(const std::string& suite, const std::string& reason) {
  MatrixOptions matrix;
  matrix.name = "night";
  matrix.suite = suite;
  matrix.open_sealed = reason;
  return matrix;
}

std::string errorOf(const MatrixOptions& matrix) {
  try {
    requireOpeningReason(matrix, "night.yaml");
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(SealedOpening, NeedsAReasonAndTheReasonASealedSuite) {
  EXPECT_EQ(errorOf(matrixOn("development", "")), "");
  EXPECT_EQ(errorOf(matrixOn("sealed_a", "the release")), "");
  EXPECT_NE(errorOf(matrixOn("sealed_a", "")).find("night.yaml: the suite sealed_a is sealed"),
            std::string::npos);
  EXPECT_NE(errorOf(matrixOn("development", "why")).find("no sealed suite is run"),
            std::string::npos);
}

TEST(SealedOpening, SingleScenariosOfASealedSuiteCountToo) {
  MatrixOptions matrix = matrixOn("", "");
  const suite::Suite sealed = suite::loadSuite("sealed_b");
  matrix.scenarios = {"crossing_left_turn", sealed.scenarioFile(sealed.routes[3]).string()};
  EXPECT_EQ(sealedSuitesOf(matrix), std::vector<std::string>{"sealed_b"});
  EXPECT_NE(errorOf(matrix).find("the suite sealed_b is sealed"), std::string::npos);
}

TEST(SealedOpening, IsRecordedALineEach) {
  const test::TemporaryFolder folder;
  const auto log = [&] { return core::readFile(folder.path() / "opened.log", "log"); };
  const MatrixOptions matrix = matrixOn("sealed_a", "first");
  EXPECT_NE(recordOpening(matrix, folder.path()).find("docs/sealed_suites.md"), std::string::npos);
  recordOpening(matrixOn("sealed_a", "second"), folder.path());
  EXPECT_NE(log().find("  sealed_a  seal "), std::string::npos) << log();
  EXPECT_NE(log().find("  matrix night  first\n"), std::string::npos) << log();
  EXPECT_NE(log().find("  matrix night  second\n"), std::string::npos) << log();
  EXPECT_EQ(recordOpening(matrixOn("development", ""), folder.path()), "");
}

TEST(SealedOpening, TheReasonDoesNotMakeAnotherMatrix) {
  EXPECT_EQ(identityOf(matrixOn("sealed_a", "first")), identityOf(matrixOn("sealed_a", "again")));
}

}  // namespace
}  // namespace cdiff::evaluation
