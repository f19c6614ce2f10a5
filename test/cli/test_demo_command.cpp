// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "cli/cdiff_command.h"

namespace cdiff::cli {
namespace {

using DemoCommand = test::CdiffCommand;

TEST_F(DemoCommand, ItRunsASessionAndNamesItsReport) {
  ASSERT_EQ(cdiff({"demo", "--results", path("demo")}), 0) << output();
  expectOutput(path("demo/report.html"));
  EXPECT_TRUE(core::isFile(path("demo/report.html")));
  EXPECT_TRUE(core::isFile(path("demo/vehicles.csv")));
}

TEST_F(DemoCommand, AFileOfTheUsersStays) {
  std::filesystem::create_directory(path("demo"));
  core::writeFileAtomically(path("demo/trace.csv"), "mine\n");
  EXPECT_EQ(cdiff({"demo", "--results", path("demo")}), 3);
  EXPECT_EQ(core::readFile(path("demo/trace.csv"), "file"), "mine\n");
}

}  // namespace
}  // namespace cdiff::cli
