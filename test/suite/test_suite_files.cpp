// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <fstream>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "suite/suite.h"
#include "support/temporary_folder.h"

namespace cdiff::suite {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHead = "schema_version: 1\nname: mine\nseed: 4\nroutes:\n";
constexpr const char* kRoute =
    "  - {name: a, network: n, edges: [e, f], start_offset: 5, end_offset: 6.5, manoeuvre: left, "
    "turn: 90, length: 120, conflicts: 2, density: low, seed: 3}\n";

/// A folder that becomes a suite by its manifest.
class SuiteFiles : public testing::Test {
 protected:
  void write(const std::string& path, const std::string& text) const {
    fs::create_directories((folder_.path() / path).parent_path());
    std::ofstream(folder_.path() / path) << text;
  }
  void writeWhole(const std::string& manifest) const {
    write("suite.yaml", manifest);
    write("networks/n/n.net.xml", "<net/>");
    write("scenarios/a.yaml", "name: a\n");
  }
  std::string errorOf() const { return errorOf(folder_.path().string()); }
  static std::string errorOf(const std::string& name) {
    try {
      loadSuite(name);
    } catch (const core::InputError& error) {
      return error.what();
    }
    return "no error";
  }
  static void expectPart(const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\nnot in\n" << text;
  }
  test::TemporaryFolder folder_;
};

TEST_F(SuiteFiles, ReadsWhatTheManifestSays) {
  writeWhole(std::string(kHead) + kRoute);
  const Suite suite = loadSuite(folder_.path().string());
  EXPECT_EQ(suite.name, "mine");
  EXPECT_EQ(suite.seed, 4);
  ASSERT_EQ(suite.routes.size(), 1U);
  EXPECT_EQ(suite.routes[0].edges, (std::vector<std::string>{"e", "f"}));
  EXPECT_EQ(suite.routes[0].end_offset, 6.5);
  EXPECT_EQ(suite.routes[0].seed, 3);
  EXPECT_EQ(fs::path(scenarioFiles(suite)[0]).filename(), "a.yaml");
}

TEST_F(SuiteFiles, NamesTheNearestShippedSuite) {
  const std::string error = errorOf("develpment");
  expectPart(error, "suite 'develpment' is neither");
  expectPart(error, "nearest shipped one is 'development'");
  expectPart(error, "cdiff suite train --results DIR");
}

TEST_F(SuiteFiles, NamesAFolderWithoutManifest) { expectPart(errorOf(), "holds no suite.yaml"); }

TEST_F(SuiteFiles, NamesTheRouteWhoseNetworkIsMissing) {
  writeWhole(std::string(kHead) + kRoute);
  fs::remove(folder_.path() / "networks/n/n.net.xml");
  expectPart(errorOf(), "route 'a': its network '");
  writeWhole(std::string(kHead) + kRoute);
  fs::remove(folder_.path() / "scenarios/a.yaml");
  expectPart(errorOf(), "route 'a': its scenario '");
}

TEST_F(SuiteFiles, NamesLineAndKeyOfAWrongManifest) {
  const auto changed = [](const std::string& from, const std::string& to) {
    std::string text = std::string(kHead) + kRoute;
    return text.replace(text.find(from), from.size(), to);
  };
  writeWhole(changed("seed: 4", "seed: four"));
  expectPart(errorOf(), "key 'seed': expected a whole number");
  writeWhole(changed("manoeuvre: left", "manoeuvre: u_turn"));
  expectPart(errorOf(), "line 5: key 'manoeuvre' is 'u_turn'; expected one of left, right");
  writeWhole(changed("density: low", "densty: low"));
  expectPart(errorOf(), "line 5: key 'density' is missing");
  writeWhole(changed("turn: 90", "turn: 90, color: red"));
  expectPart(errorOf(), "unknown key 'color'");
  writeWhole(changed("seed: 4", "seed: 4\n? [a, b]\n: 1"));
  expectPart(errorOf(), "expected keys that are plain words");
  writeWhole(changed("length: 120", "length: long"));
  expectPart(errorOf(), "key 'length': expected a number");
  writeWhole(changed("schema_version: 1", "schema_version: 2"));
  expectPart(errorOf(), "key 'schema_version': expected 1");
  writeWhole(std::string(kHead) + kRoute + kRoute);
  expectPart(errorOf(), "line 6: a second route is called 'a'");
  writeWhole("schema_version: 1\nname: mine\nseed: 4\n");
  expectPart(errorOf(), "key 'routes': expected a list of routes");
  writeWhole("name: [broken\n");
  expectPart(errorOf(), "line ");
}

}  // namespace
}  // namespace cdiff::suite
