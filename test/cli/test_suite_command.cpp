// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <filesystem>
#include <fstream>
#include <map>

#include "cli/cdiff_command.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;

class SuiteCommand : public test::CdiffCommand {
 protected:
  /// Writes the hashes of all files of a suite.
  static void seal(const fs::path& suite) {
    std::map<std::string, std::string> hashes;
    for (const auto& entry : fs::recursive_directory_iterator(suite)) {
      if (entry.is_regular_file())
        hashes[fs::relative(entry.path(), suite).string()] =
            core::sha256(core::readFile(entry.path(), "file"));
    }
    std::ofstream file(suite / "seal.sha256");
    for (const auto& [name, hash] : hashes) file << hash << "  " << name << "\n";
  }
};

TEST_F(SuiteCommand, MakesASuiteThatAMatrixDrives) {
  ASSERT_EQ(cdiff({"suite", "development", "--seed", "1", "--results", path("suite")}), 0);
  expectOutput("10 routes on 7 networks");
  EXPECT_FALSE(fs::exists(path("suite.part")));
  std::ofstream(path("matrix.yaml")) << "suite: suite\ncbv_planners: [pdm_lite]\nset: "
                                        "[protocol.time_limit=1, verdict.judge=false]\n";
  ASSERT_EQ(cdiff({"evaluate", path("matrix.yaml"), "--results", path("runs"), "--jobs", "2"}), 0);
  expectOutput("10/10 done, 0 broken");
  EXPECT_TRUE(fs::exists(path("runs/runs/development_merge_1__seed10/summary.json")));
}

TEST_F(SuiteCommand, RefusesWhatIsNoSuiteOrNoSeed) {
  EXPECT_EQ(cdiff({"suite", "trian", "--results", path("a")}), 3);
  expectOutput("trian");
  EXPECT_EQ(cdiff({"suite", "development", "--seed", "first", "--results", path("a")}), 3);
  expectOutput("--seed");
  EXPECT_EQ(cdiff({"suite", "development", "--seed", "-1", "--results", path("a")}), 3);
  EXPECT_FALSE(fs::exists(path("a")));
  std::ofstream(path("mine")) << "mine";
  EXPECT_EQ(cdiff({"suite", "development", "--results", path("mine")}), 3);
  expectOutput(path("mine"));
}

/// A copy of one route under a seal of its own, so that no sealed suite is opened by a test.
TEST_F(SuiteCommand, ASealedSuiteIsOpenedWithAReasonOnly) {
  ASSERT_EQ(cdiff({"suite", "development", "--results", path("suite")}), 0);
  const auto add = [&](const std::string& text) {
    std::string manifest = core::readFile(path("suite/suite.yaml"), "manifest");
    manifest.resize(manifest.find("routes:"));
    std::ofstream(path("suite/suite.yaml")) << manifest << text;
  };
  const std::string manifest = core::readFile(path("suite/suite.yaml"), "manifest");
  const std::size_t first = manifest.find("  - {");
  add("sealed: true\nroutes:\n" + manifest.substr(first, manifest.find('\n', first) - first) +
      "\n");
  seal(path("suite"));
  std::ofstream(path("matrix.yaml")) << "suite: suite\ncbv_planners: [pdm_lite]\nset: "
                                        "[protocol.time_limit=1, verdict.judge=false]\n";
  const std::vector<std::string> command = {"evaluate", path("matrix.yaml"), "--results",
                                            path("runs")};
  EXPECT_EQ(cdiff(command), 3);
  expectOutput("the suite development is sealed");
  EXPECT_FALSE(fs::exists(path("runs")));
  EXPECT_EQ(
      cdiff({"run", path("suite/scenarios/development_left_1.yaml"), "--results", path("runs")}),
      3);
  expectOutput("is a route of the sealed suite suite");
  EXPECT_FALSE(fs::exists(path("runs")));
  std::vector<std::string> opening = command;
  opening.insert(opening.end(), {"--open-sealed", "a test"});
  EXPECT_EQ(cdiff(opening), 0);
  expectOutput("add this to docs/sealed_suites.md");
  const std::string log = core::readFile(path("runs/opened.log"), "log");
  EXPECT_NE(log.find("  development  seal "), std::string::npos) << log;
  EXPECT_NE(log.find("  a test\n"), std::string::npos) << log;
#ifdef E2E_CDIFF_WITH_ROS
  EXPECT_EQ(cdiff({"collect", "--suite", path("suite"), "--results", path("data")}), 3);
  expectOutput("from which no training data may come");
#endif
}

#ifdef E2E_CDIFF_WITH_ROS
/// Neither as it ships, nor made anew, nor by single routes.
TEST_F(SuiteCommand, NoTrainingDataComeFromTheDevelopmentSuite) {
  ASSERT_EQ(cdiff({"suite", "development", "--results", path("suite")}), 0);
  const std::vector<std::vector<std::string>> sources = {
      {"--suite", "development"},
      {"--suite", path("suite")},
      {"--scenarios", path("suite/scenarios/development_left_1.yaml")}};
  for (const std::vector<std::string>& source : sources) {
    std::vector<std::string> command = {"collect", "--results", path("data")};
    command.insert(command.end(), source.begin(), source.end());
    EXPECT_EQ(cdiff(command), 3) << source.back();
    expectOutput("suite 'development' is for evaluation");
    EXPECT_FALSE(fs::exists(path("data"))) << source.back();
  }
}
#endif

TEST_F(SuiteCommand, UnknownSuitesAreNamedBeforeAnythingRuns) {
  std::ofstream(path("matrix.yaml")) << "suite: develpment\n";
  EXPECT_EQ(cdiff({"evaluate", path("matrix.yaml"), "--results", path("runs")}), 3);
  expectOutput("nearest shipped one is 'development'");
#ifdef E2E_CDIFF_WITH_ROS
  EXPECT_EQ(cdiff({"collect", "--suite", "develpment", "--results", path("data")}), 3);
  expectOutput("nearest shipped one is 'development'");
  EXPECT_FALSE(fs::exists(path("data")));
#endif
}

#ifdef E2E_CDIFF_WITH_ROS
/// The merge route's traffic is high: 16 vehicles.
TEST_F(SuiteCommand, CollectDrivesTheRoutesWithTheirTraffic) {
  ASSERT_EQ(cdiff({"suite", "development", "--results", path("suite")}), 0);
  const std::string manifest = core::readFile(path("suite/suite.yaml"), "manifest");
  const std::string name = "name: development\n";
  ASSERT_NE(manifest.find(name), std::string::npos);
  std::ofstream(path("suite/suite.yaml"))
      << std::string(manifest).replace(manifest.find(name), name.size(), "name: mine\n");
  ASSERT_EQ(cdiff({"collect", "--suite", path("suite"), "--results", path("data"), "--duration",
                   "5", "--jobs", "2", "--set", "traffic.warm_up=5"}),
            0);
  expectOutput("10 sessions, 0 of them already there");
  const std::string shard =
      core::readFile(path("data/shards/development_merge_1_seed1.shard"), "shard");
  EXPECT_NE(shard.find("maximum_density: 16"), std::string::npos);
}
#endif

}  // namespace
}  // namespace cdiff::cli
