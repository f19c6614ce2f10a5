// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <set>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "session/session_setup.h"
#include "suite/suite_generator.h"
#include "support/temporary_folder.h"

namespace cdiff::suite {
namespace {

namespace fs = std::filesystem;

/// SHA-256 of every file of a folder, by its path in it.
std::map<std::string, std::string> hashesOf(const fs::path& folder) {
  std::map<std::string, std::string> hashes;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    const std::string path = fs::relative(entry.path(), folder).string();
    hashes[path] = core::sha256(core::readFile(entry.path(), "file"));
  }
  return hashes;
}

std::map<std::string, int> manoeuvreCounts(const Suite& suite) {
  std::map<std::string, int> counts;
  for (const SuiteRoute& route : suite.routes) ++counts[route.manoeuvre];
  return counts;
}

std::set<std::string> networksOf(const Suite& suite) {
  std::set<std::string> networks;
  for (const SuiteRoute& route : suite.routes) networks.insert(route.network);
  return networks;
}

/// The training suite, generated once for all tests.
class TrainingSuite : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    suite_ = new Suite(generateSuite("train", defaultSeed("train"), folder_->path() / "train"));
  }
  static void TearDownTestSuite() {
    delete suite_;
    delete folder_;
  }
  static test::TemporaryFolder* folder_;
  static Suite* suite_;
};
test::TemporaryFolder* TrainingSuite::folder_ = nullptr;
Suite* TrainingSuite::suite_ = nullptr;

TEST_F(TrainingSuite, HasTheCountsOfItsManifest) {
  const std::map<std::string, int> expected = {
      {"left", 66}, {"right", 66}, {"straight", 44}, {"roundabout", 22}, {"merge", 22}};
  EXPECT_EQ(manoeuvreCounts(*suite_), expected);
  EXPECT_EQ(suite_->routes.size(), 220U);
  EXPECT_EQ(networksOf(*suite_).size(), 38U);
  std::map<std::string, int> densities;
  for (const SuiteRoute& route : suite_->routes) ++densities[route.density];
  // 66, 66, 44, 22 and 22 routes take the three levels in turn: 22 + 22 + 15 + 8 + 8 low ones.
  EXPECT_EQ(densities["low"], 75);
  EXPECT_EQ(densities["medium"], 73);
  EXPECT_EQ(densities["high"], 72);
}

TEST_F(TrainingSuite, ReadsBackFromItsFolder) {
  const Suite again = loadSuite(suite_->folder.string());
  EXPECT_EQ(manifestText(again), manifestText(*suite_));
  EXPECT_EQ(scenarioFiles(again).size(), 220U);
}

TEST_F(TrainingSuite, SameSeedGivesTheSameBytes) {
  generateSuite("train", defaultSeed("train"), folder_->path() / "again");
  EXPECT_EQ(hashesOf(suite_->folder), hashesOf(folder_->path() / "again"));
}

TEST_F(TrainingSuite, EveryRouteIsWhatItSays) {
  std::set<std::string> paths;
  for (const SuiteRoute& route : suite_->routes) {
    SCOPED_TRACE(route.name);
    const session::ScenarioOptions options =
        session::loadScenario(suite_->scenarioFile(route).string());
    EXPECT_EQ(options.name, route.name);
    EXPECT_EQ(options.traffic.density, vehiclesAt(route.density));
    EXPECT_EQ(options.route.edges, route.edges);
    const session::SessionSetup setup(options);
    EXPECT_GE(setup.egoRoute().length(), 80.0);
    EXPECT_LE(setup.egoRoute().length(), 200.0);
    EXPECT_FALSE(setup.egoRoute().junctionStretches().empty());
    EXPECT_GE(route.conflicts, 1);
    paths.insert(route.network + core::dumpOptions(options.route));
  }
  EXPECT_EQ(paths.size(), suite_->routes.size()) << "two routes are the same";
}

TEST_F(TrainingSuite, SharesNoNetworkWithAnyShippedSuite) {
  std::set<std::string> names;
  std::set<std::string> edges;
  for (const auto& [path, hash] : hashesOf(suite_->folder / "networks")) {
    names.insert(fs::path(path).filename().string());
    if (path.find(".edg.xml") != std::string::npos) edges.insert(hash);
  }
  EXPECT_EQ(edges.size(), 38U) << "two training networks have the same edges";
  EXPECT_EQ(shippedSuites(), (std::vector<std::string>{"development", "sealed_a", "sealed_b",
                                                       "sealed_c", "sealed_d"}));
  for (const std::string& shipped : shippedSuites()) {
    for (const auto& [path, hash] : hashesOf(loadSuite(shipped).folder / "networks")) {
      EXPECT_EQ(names.count(fs::path(path).filename().string()), 0U) << path;
      EXPECT_EQ(edges.count(hash), 0U) << path;
    }
  }
}

TEST(SuiteGenerator, AnotherSeedGivesOtherNetworks) {
  const test::TemporaryFolder folder;
  generateSuite("development", 1, folder.path() / "one");
  generateSuite("development", 2, folder.path() / "two");
  const auto one = hashesOf(folder.path() / "one" / "networks");
  const auto two = hashesOf(folder.path() / "two" / "networks");
  ASSERT_EQ(one.size(), two.size());
  for (const auto& [path, hash] : one) {
    const bool connections = path.find(".con.xml") != std::string::npos;  // ids and lanes alone
    if (!connections) {
      EXPECT_NE(hash, two.at(path)) << path;
    }
  }
}

TEST(SuiteGenerator, RefusesAFolderThatHoldsSomething) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path() / "mine.txt") << "mine";
  EXPECT_THROW(generateSuite("development", 1, folder.path()), core::InputError);
  EXPECT_TRUE(fs::exists(folder.path() / "mine.txt"));
}

}  // namespace
}  // namespace cdiff::suite
