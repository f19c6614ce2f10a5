// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/map/road_network.h"
#include "session/session_setup.h"
#include "suite/seal.h"
#include "suite/suite.h"
#include "support/temporary_folder.h"

namespace cdiff::suite {
namespace {

namespace fs = std::filesystem;

/// What loading a suite says.
std::string errorOf(const std::string& name) {
  try {
    loadSuite(name);
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "no error";
}

void expectPart(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << part << "\nnot in\n" << text;
}

/// A copy of a sealed suite, to be changed.
class SealedCopy : public testing::Test {
 protected:
  SealedCopy() {
    fs::copy(loadSuite("sealed_a").folder, copy_, fs::copy_options::recursive);
    EXPECT_EQ(error(), "no error");
  }
  std::string error() const { return errorOf(copy_.string()); }
  void append(const std::string& path, const std::string& text) const {
    std::ofstream(copy_ / path, std::ios::app) << text;
  }
  test::TemporaryFolder folder_;
  fs::path copy_ = folder_.path() / "sealed_a";
};

TEST_F(SealedCopy, AChangedFileIsRefusedWithBothHashes) {
  const fs::path scenario = copy_ / "scenarios" / "sealed_a_03.yaml";
  const std::string before = core::sha256(core::readFile(scenario, "scenario"));
  append("scenarios/sealed_a_03.yaml", "\n");
  const std::string after = core::sha256(core::readFile(scenario, "scenario"));
  expectPart(error(), "sealed_a_03.yaml' differs from its seal (expected SHA-256 " + before +
                          ", found " + after + "); a sealed suite must not change");
}

TEST_F(SealedCopy, ChangedNetworksAndManifestsAreRefused) {
  append("networks/sealed_a_merge/sealed_a_merge.net.xml", " ");
  expectPart(error(), "sealed_a_merge.net.xml' differs from its seal");
  append("suite.yaml", "# \n");
  expectPart(errorOf(copy_.string()), "differs from its seal");
}

TEST_F(SealedCopy, MissingAndAddedFilesAreRefused) {
  append("scenarios/mine.yaml", "name: mine\n");
  expectPart(error(), "mine.yaml' is not in ");
  fs::remove(copy_ / "scenarios" / "mine.yaml");
  fs::remove(copy_ / "networks" / "sealed_a_merge" / "sealed_a_merge.nod.xml");
  expectPart(error(), "found no file");
}

TEST_F(SealedCopy, WithoutItsSealItIsRefused) {
  fs::remove(copy_ / kSealFile);
  expectPart(error(), "key 'sealed' and the file seal.sha256 go together");
}

TEST_F(SealedCopy, ADamagedSealIsRefused) {
  append(kSealFile, "short line\n");
  expectPart(error(), "line 'short line' is not");
}

TEST(SealedScenario, IsFoundByItsFolder) {
  const Suite sealed = loadSuite("sealed_b");
  const std::string file = sealed.scenarioFile(sealed.routes.front()).string();
  ASSERT_TRUE(sealedSuiteOf(file));
  EXPECT_EQ(sealedSuiteOf(file)->filename(), "sealed_b");
  EXPECT_THROW(requireNotSealed(file), core::InputError);
  EXPECT_FALSE(sealedSuiteOf("crossing_left_turn"));
  const Suite open = loadSuite("development");
  EXPECT_NO_THROW(requireNotSealed(open.scenarioFile(open.routes.front()).string()));
}

class SealedSuite : public testing::TestWithParam<const char*> {};

/// The seals as they were drawn, also in docs/sealed_suites.md: a suite that was sealed anew is
/// another suite.
TEST(SealedSuites, HaveTheSealsOfTheirDrawing) {
  const auto hashOf = [](const char* name) {
    return core::sha256(core::readFile(loadSuite(name).folder / kSealFile, "seal"));
  };
  EXPECT_EQ(hashOf("sealed_a"), "bb7de57f1463c2d9f860bd82d2520911c77dee8081573b0686f0ff392af62e41");
  EXPECT_EQ(hashOf("sealed_b"), "06a475b790291a99f077755be3e2b9261450fadac553eb083cce286afb10a4a3");
  EXPECT_EQ(hashOf("sealed_c"), "092486ac25a81b96c86b691281ba45abb8ca2444f95edc494d85981c4d6dfdf9");
  EXPECT_EQ(hashOf("sealed_d"), "d9c8f2df3a0ac539aa3a5ead94c928cc5bfddbed3600687ab5e121c48b068e04");
}

TEST_P(SealedSuite, HasSixteenRoutesOnAsManyNetworksHalfOfThemGenerated) {
  const Suite suite = loadSuite(GetParam());
  EXPECT_TRUE(suite.sealed);
  EXPECT_EQ(suite.routes.size(), 16U);
  std::set<std::string> networks;
  std::set<std::string> generated;
  for (const SuiteRoute& route : suite.routes) {
    networks.insert(route.network);
    const fs::path types = suite.folder / "networks" / route.network / (route.network + ".typ.xml");
    if (fs::exists(types)) generated.insert(route.network);  // netgenerate's only source
  }
  EXPECT_EQ(networks.size(), 16U);
  EXPECT_EQ(generated.size(), 8U);
}

/// The rule's 150 to 300 m are on the rightmost lanes; the route's own line may differ by 20 m.
TEST_P(SealedSuite, EveryRouteIsDrivableUnderTheProtocolOfFortySeconds) {
  const Suite suite = loadSuite(GetParam());
  for (const SuiteRoute& route : suite.routes) {
    SCOPED_TRACE(route.name);
    const session::ScenarioOptions options =
        session::loadScenario(suite.scenarioFile(route).string());
    EXPECT_EQ(options.protocol.preset, "rift_dev10");
    EXPECT_EQ(options.protocol.time_limit, 40.0);
    EXPECT_EQ(options.traffic.density, vehiclesAt(route.density));
    EXPECT_EQ(options.demand, "generated");
    const session::SessionSetup setup(options);
    EXPECT_NEAR(setup.egoRoute().length(), route.length, 20.0);
    EXPECT_FALSE(setup.egoRoute().junctionStretches().empty());
  }
}

INSTANTIATE_TEST_SUITE_P(Each, SealedSuite,
                         testing::Values("sealed_a", "sealed_b", "sealed_c", "sealed_d"),
                         [](const auto& info) { return std::string(info.param); });

std::set<std::string> edgesOf(const Suite& suite) {
  std::set<std::string> edges;
  for (const SuiteRoute& route : suite.routes) {
    const map::RoadNetwork network = map::RoadNetwork::fromText(
        core::readFile(suite.networkFile(route), "network"), route.network);
    for (const std::string& edge : network.edgeIds()) edges.insert(edge);
  }
  return edges;
}

TEST(SealedSuites, ShareNoEdgeWithEachOther) {
  std::set<std::string> known;
  for (const char* suite : {"sealed_a", "sealed_b", "sealed_c", "sealed_d"})
    for (const std::string& edge : edgesOf(loadSuite(suite)))
      EXPECT_TRUE(known.insert(edge).second) << edge << " of " << suite;
}

}  // namespace
}  // namespace cdiff::suite
