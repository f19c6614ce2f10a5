// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <filesystem>
#include <fstream>

#include "cli/cdiff_command.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;

class SuiteCommand : public test::CdiffCommand {};

TEST_F(SuiteCommand, MakesASuiteThatAMatrixDrives) {
  ASSERT_EQ(cdiff({"suite", "test", "--seed", "1", "--results", path("suite")}), 0);
  expectOutput("10 routes on 7 networks");
  EXPECT_FALSE(fs::exists(path("suite.part")));
  std::ofstream(path("matrix.yaml")) << "suite: suite\ncbv_planners: [pdm_lite]\nset: "
                                        "[protocol.time_limit=1, verdict.judge=false]\n";
  ASSERT_EQ(cdiff({"evaluate", path("matrix.yaml"), "--results", path("runs"), "--jobs", "2"}), 0);
  expectOutput("10/10 done, 0 failed");
  EXPECT_TRUE(fs::exists(path("runs/runs/test_merge_1__seed10/summary.json")));
}

TEST_F(SuiteCommand, RefusesWhatIsNoSuiteOrNoSeed) {
  EXPECT_EQ(cdiff({"suite", "trian", "--results", path("a")}), 3);
  expectOutput("trian");
  EXPECT_EQ(cdiff({"suite", "test", "--seed", "first", "--results", path("a")}), 3);
  expectOutput("--seed");
  EXPECT_EQ(cdiff({"suite", "test", "--seed", "-1", "--results", path("a")}), 3);
  EXPECT_FALSE(fs::exists(path("a")));
  std::ofstream(path("mine")) << "mine";
  EXPECT_EQ(cdiff({"suite", "test", "--results", path("mine")}), 3);
  expectOutput("is there already");
}

TEST_F(SuiteCommand, UnknownSuitesAreNamedBeforeAnythingRuns) {
  std::ofstream(path("matrix.yaml")) << "suite: tets\n";
  EXPECT_EQ(cdiff({"evaluate", path("matrix.yaml"), "--results", path("runs")}), 3);
  expectOutput("nearest shipped one is 'test'");
#ifdef E2E_CDIFF_WITH_ROS
  EXPECT_EQ(cdiff({"collect", "--suite", "tets", "--results", path("data")}), 3);
  expectOutput("nearest shipped one is 'test'");
  EXPECT_FALSE(fs::exists(path("data")));
#endif
}

#ifdef E2E_CDIFF_WITH_ROS
/// The merge route's traffic is high: 16 vehicles.
TEST_F(SuiteCommand, CollectDrivesTheRoutesWithTheirTraffic) {
  ASSERT_EQ(cdiff({"collect", "--suite", "test", "--results", path("data"), "--duration", "5",
                   "--jobs", "2", "--set", "traffic.warm_up=5"}),
            0);
  expectOutput("10 sessions, 0 of them already there");
  const std::string shard = core::readFile(path("data/shards/test_merge_1_seed1.shard"), "shard");
  EXPECT_NE(shard.find("maximum_density: 16"), std::string::npos);
}
#endif

}  // namespace
}  // namespace cdiff::cli
