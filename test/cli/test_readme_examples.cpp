// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "cli/cdiff_command.h"

namespace cdiff::cli {
namespace {

/// A session that README.md or scripts/demo names by scenario and seed.
struct Example {
  std::string scenario;
  std::string seed;
  std::string mode;
  bool operator<(const Example& other) const {
    return std::tie(scenario, seed, mode) < std::tie(other.scenario, other.seed, other.mode);
  }
};

std::set<Example> examplesIn(const std::string& file) {
  const std::string text = core::readFile(core::shareFolder() / file, file);
  const std::regex pattern(
      "(?:scenario:=(\\w+) seed:=(\\d+)|cdiff run (\\w+) --seed (\\d+))([^\\n#]*)");
  std::set<Example> examples;
  for (std::sregex_iterator match(text.begin(), text.end(), pattern), end; match != end; ++match) {
    const bool attack = (*match)[5].str().find("safety_critical") != std::string::npos;
    examples.insert({(*match)[1].str() + (*match)[3].str(), (*match)[2].str() + (*match)[4].str(),
                     attack ? "safety_critical" : "naturalistic"});
  }
  return examples;
}

class ReadmeExamples : public test::CdiffCommand {};

/// As README says: naturalistic examples pass with CBVs, the attacked one ends struck.
TEST_F(ReadmeExamples, EndWell) {
  std::set<Example> examples = examplesIn("README.md");
  EXPECT_EQ(examples.size(), 2U);
  const std::set<Example> demo = examplesIn("scripts/demo");
  EXPECT_EQ(demo.size(), 1U);
  examples.insert(demo.begin(), demo.end());
  for (const Example& example : examples) {
    SCOPED_TRACE(example.scenario + " " + example.seed + " " + example.mode);
    const std::string folder = path(example.scenario + example.seed + example.mode);
    EXPECT_EQ(cdiff({"run", example.scenario, "--seed", example.seed, "--mode", example.mode,
                     "--quiet", "--results", folder}),
              0);
    const auto summary = nlohmann::json::parse(core::readFile(folder + "/summary.json", "summary"));
    EXPECT_EQ(summary["verdict"]["outcome"], example.mode == "naturalistic" ? "passed" : "struck");
    EXPECT_EQ(summary["status"], "completed");
    EXPECT_GT(summary["cbv"]["count"], 0);
    // They interact: a CBV leaves a place and the ego comes there within 3 s, or the reverse.
    EXPECT_LT(summary["metrics"]["post_encroachment_s"]["min"], 3.0);
  }
}

}  // namespace
}  // namespace cdiff::cli
