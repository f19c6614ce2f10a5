// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// `cdiff export` on a short session: its result folder, a folder of such folders, its bag.
#include "cli/cdiff_command.h"
#include "core/csv.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;

constexpr int kBadInput = 3;

class ExportCommand : public test::CdiffCommand {
 protected:
  void SetUp() override {
    std::vector<std::string> words = {"run",
                                      "roundabout_cross",
                                      "--cbv-planner",
                                      "pdm_lite",
                                      "--ego-planner",
                                      "constant",
                                      "--set",
                                      "protocol.time_limit=2",
                                      "--set",
                                      "report.front_view_rate=0",
                                      "--quiet",
                                      "--results",
                                      path("cases/first")};
#ifdef E2E_CDIFF_WITH_ROS
    words.emplace_back("--record");
#endif
    ASSERT_LE(cdiff(words), 1) << output();
  }
  int exportOf(const std::string& source, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"export", path(source), "--output", path("exported")};
    words.insert(words.end(), more.begin(), more.end());
    return cdiff(words);
  }
  std::string text(const std::string& name) const { return core::readFile(path(name), "file"); }
};

TEST_F(ExportCommand, AFolderOfCasesGivesAFileEachOneNetworkAndAnIndex) {
  fs::copy(path("cases/first"), path("cases/second"), fs::copy_options::recursive);
  ASSERT_EQ(exportOf("cases"), 0) << output();
  expectOutput("largest distance of lane centers");
  for (const char* name : {"first.xosc", "second.xosc", "roundabout.xodr"})
    EXPECT_TRUE(core::isFile(path(std::string("exported/") + name))) << name;
  EXPECT_EQ(text("exported/first.xosc"), text("exported/second.xosc"));
  const std::string index = text("exported/index.csv");
  const std::vector<core::CsvRow> rows = core::csvRows(index);
  ASSERT_EQ(rows.size(), 3U);
  const std::vector<std::string> cells = core::csvCells(rows[1].text);
  EXPECT_EQ(cells[0], "first.xosc");
  EXPECT_EQ(cells[1], "roundabout_cross");
  EXPECT_EQ(cells[6], "pdm_lite");
}

TEST_F(ExportCommand, WhatCannotBeIsRefusedAndNothingIsWritten) {
  EXPECT_EQ(exportOf("nothing"), kBadInput);
  expectOutput("no session.yaml");
  EXPECT_EQ(exportOf("cases/first", {"--format", "fbx"}), kBadInput);
  expectOutput("expected openscenario, commonroad or csv");
  EXPECT_EQ(exportOf("cases/first", {"--format", "csv", "--ego", "external"}), kBadInput);
  expectOutput("only --format openscenario");
  EXPECT_EQ(exportOf("cases/first", {"--vehicles", "bus"}), kBadInput);
  EXPECT_FALSE(fs::exists(path("exported")));
}

TEST_F(ExportCommand, TwoSessionsOfOneFileNameAreRefused) {
  fs::copy(path("cases/first"), path("cases/a b"), fs::copy_options::recursive);
  fs::copy(path("cases/first"), path("cases/a_b"), fs::copy_options::recursive);
  EXPECT_EQ(exportOf("cases", {"--format", "csv"}), kBadInput);
  expectOutput("would both be 'a_b.csv'");
}

TEST_F(ExportCommand, AFileOfTheUsersStays) {
  fs::create_directory(path("exported"));
  core::writeFileAtomically(path("exported/first.csv"), "mine\n");
  EXPECT_EQ(exportOf("cases/first", {"--format", "csv"}), kBadInput);
  EXPECT_EQ(text("exported/first.csv"), "mine\n");
}

#ifdef E2E_CDIFF_WITH_ROS
TEST_F(ExportCommand, TheBagGivesTheSameAsTheResultFolder) {
  ASSERT_EQ(exportOf("cases/first", {"--format", "csv", "--vehicles", "all"}), 0) << output();
  ASSERT_EQ(exportOf("cases/first/session.bag", {"--format", "csv", "--vehicles", "all"}), 0)
      << output();
  EXPECT_EQ(text("exported/session.csv"), text("exported/first.csv"));
}
#endif

}  // namespace
}  // namespace cdiff::cli
