// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <algorithm>
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
  std::string set;  ///< the key that it sets, empty without one
  bool operator<(const Example& other) const {
    return std::tie(scenario, seed, mode, set) <
           std::tie(other.scenario, other.seed, other.mode, other.set);
  }
};

std::set<Example> examplesIn(const std::string& file) {
  const std::string text = core::readFile(core::shareFolder() / file, file);
  const std::regex pattern(
      "(?:scenario:=(\\w+) seed:=(\\d+)|cdiff run (\\w+) --seed (\\d+))([^\\n#]*)");
  std::set<Example> examples;
  for (std::sregex_iterator match(text.begin(), text.end(), pattern), end; match != end; ++match) {
    const std::string rest = (*match)[5].str();
    const bool attack = rest.find("safety_critical") != std::string::npos;
    std::smatch set;
    std::regex_search(rest, set, std::regex("--set (\\S+)"));
    examples.insert({(*match)[1].str() + (*match)[3].str(), (*match)[2].str() + (*match)[4].str(),
                     attack ? "safety_critical" : "naturalistic", set[1].str()});
  }
  return examples;
}

class ReadmeExamples : public test::CdiffCommand {};

/// As README says: naturalistic examples pass with CBVs, the attacked one ends struck.
TEST_F(ReadmeExamples, EndWell) {
  std::set<Example> examples = examplesIn("README.md");
  EXPECT_GE(examples.size(), 2U);
  EXPECT_TRUE(std::any_of(examples.begin(), examples.end(), [](const Example& example) {
    return example.mode == "safety_critical";
  }));
  const std::set<Example> demo = examplesIn("scripts/demo");
  EXPECT_EQ(demo.size(), 1U);
  examples.insert(demo.begin(), demo.end());
  for (const Example& example : examples) {
    SCOPED_TRACE(example.scenario + " " + example.seed + " " + example.mode + " " + example.set);
    const std::string folder = path(example.scenario + example.seed + example.mode + example.set);
    std::vector<std::string> arguments = {"run",        example.scenario, "--seed",
                                          example.seed, "--mode",         example.mode,
                                          "--results",  folder,           "--quiet"};
    if (!example.set.empty()) arguments.insert(arguments.end(), {"--set", example.set});
    EXPECT_EQ(cdiff(arguments), 0);
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
