// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <memory>

#include "evaluation/comparison/comparison.h"
#include "evaluation/comparison/comparison_text.h"
#include "evaluation/run_records.h"

namespace cdiff::evaluation {
namespace {

using test::recordWith;

/// One run each, with these settings.
RunSet setWith(const std::string& name, const std::string& profile, const Settings& settings) {
  RunSet set{name, {recordWith({"s", "1", profile}, 10)}};
  set.conditions.settings[set.records[0].id] = std::make_shared<const Settings>(settings);
  return set;
}

std::string differenceOf(const RunSet& a, const RunSet& b) {
  const std::string text = comparisonMarkdown({compareRuns(a, b, sharedFactors(a, b), {})});
  const std::size_t begin = text.find("A and B differ in: ");
  return text.substr(begin, text.find('\n', begin) - begin);
}

TEST(Comparison, NamesWhatAAndBDifferIn) {
  const Settings image = {{"diffusion.conditioning", "\"image\""},
                          {"guidance_profile", "\"none\""},
                          {"seed", "1"},
                          {"network", "\"/here/town.net.xml\""}};
  Settings route = image;
  route["diffusion.conditioning"] = "\"image_route\"";
  route["network"] = "\"/there/town.net.xml\"";  // its content is compared
  RunSet a = setWith("A", "none", image);
  EXPECT_EQ(differenceOf(a, setWith("B", "none", image)),
            "A and B differ in: no factor, key or file.");
  EXPECT_EQ(differenceOf(a, setWith("B", "none", route)),
            "A and B differ in: key diffusion.conditioning (A image, B image_route).");
  route["guidance_profile"] = "\"speed\"";  // a factor: named once
  RunSet b = setWith("B", "speed", route);
  a.records[0].inputs = {{"cbv_weights", "1"}, {"program", "1"}};
  b.records[0].inputs = {{"cbv_weights", "1"}, {"program", "2"}};
  EXPECT_EQ(differenceOf(a, b),
            "A and B differ in: guidance_profile (A none, B speed); key diffusion.conditioning (A "
            "image, B image_route); file program.");
}

TEST(Comparison, SaysInHowManyPairsASettingDiffers) {
  RunSet a;
  RunSet b;
  for (const char* scenario : {"s", "t"}) {
    for (RunSet* set : {&a, &b}) {
      set->records.push_back(recordWith({scenario, "1"}, 10));
      const bool other = set == &b && *scenario == 't';
      set->conditions.settings[set->records.back().id] =
          std::make_shared<const Settings>(Settings{{"max_cbv", other ? "3" : "2"}});
    }
  }
  EXPECT_EQ(differenceOf(a, b), "A and B differ in: key max_cbv (A 2, B 2, 3, in 1 of 2 pairs).");
}

// Two runs of B are averaged into one pair.
TEST(Comparison, NamesEveryLevelOfAGroup) {
  RunSet a{"A", {recordWith({"s", "1", "none"}, 10)}};
  RunSet b{"B", {recordWith({"s", "1", "speed"}, 10), recordWith({"s", "1", "drive"}, 20)}};
  const std::string text = differenceOf(a, b);
  EXPECT_NE(text.find("guidance_profile (A none, B drive and speed)"), std::string::npos) << text;
}

TEST(Comparison, CountsOneOfAKind) {
  const RunSet a = setWith("A", "none", {});
  const std::string text = comparisonMarkdown({compareRuns(a, a, sharedFactors(a, a), {})});
  EXPECT_NE(text.find("\n1 pair of 1 run of A and 1 of B: 1 route x 1 seed;"), std::string::npos)
      << text;
}

}  // namespace
}  // namespace cdiff::evaluation
