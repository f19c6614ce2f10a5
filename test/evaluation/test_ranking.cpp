// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "evaluation/heat_map.h"
#include "evaluation/ranking.h"
#include "evaluation/run_records.h"
#include "evaluation/system_names.h"

namespace cdiff::evaluation {
namespace {

/// A complete run of one CBV planner with contacts in 0.1 km as CBV.
RunRecord attacked(const std::string& scenario, const std::string& planner, const std::string& mode,
                   double contacts) {
  RunRecord record = test::recordWith({scenario, "1"}, 80.0 - contacts);
  record.factors["cbv_planner"] = planner;
  record.factors["mode"] = mode;
  record.factors["guidance_profile"] = mode;  // follows the mode
  record.id += planner + mode;
  record.measures["cbv_ego_collisions"] = contacts;
  record.measures["cbv_distance_m"] = 100.0;
  record.measures["ego_contacts_at_fault"] = contacts > 1.0 ? 1.0 : 0.0;
  return record;
}

/// Two scenarios; diffusion touches the ego 8 times in attack, else no one does.
std::vector<RunRecord> hardAndHarmless() {
  std::vector<RunRecord> records;
  for (const auto& [scenario, contacts] : {std::pair{"a", 3.0}, std::pair{"b", 5.0}}) {
    records.push_back(attacked(scenario, "pdm_lite", "naturalistic", 0.0));
    records.push_back(attacked(scenario, "diffusion", "safety_critical", contacts));
    records.push_back(attacked(scenario, "diffusion", "naturalistic", 0.0));
  }
  return records;
}

std::vector<std::string> sentencesOf(const std::vector<RunRecord>& records) {
  const std::vector<System> systems = systemsOf(records);
  const SystemNames names(systems);
  return rankingSentences(rankingOf(systems, records, names), names);
}

TEST(SystemNames, HoldWhatDistinguishesSystemsAlone) {
  const std::vector<System> systems = systemsOf(hardAndHarmless());
  const SystemNames names(systems);
  ASSERT_EQ(systems.size(), 3u);
  EXPECT_EQ(names.of(systems[0].factors), "pdm_lite driving naturally");
  EXPECT_EQ(names.of(systems[1].factors), "diffusion in attack");
  EXPECT_FALSE(names.egosDiffer());
  EXPECT_EQ(names.of(hardAndHarmless()[1].factors), "diffusion in attack");  // of a run
}

TEST(SystemNames, NameTheEgoWhereEgosDiffer) {
  std::vector<RunRecord> records = {test::recordWith({}, 1.0), test::recordWith({}, 2.0)};
  records[1].factors["ego_planner"] = "plant";
  const SystemNames names(systemsOf(records));
  EXPECT_EQ(names.of(records[1].factors), "ego plant");
  EXPECT_TRUE(names.egosDiffer());
}

// 8 contacts in 0.2 km: 40 per km, Garwood 3.4538 to 15.7632 over 0.2 km; the exact test against 0
// on equal km gives 2 / 2^8 = 0.0078, twice that after Holm.
TEST(Ranking, NamesTheHardestWithItsUncertainty) {
  const std::vector<std::string> sentences = sentencesOf(hardAndHarmless());
  ASSERT_EQ(sentences.size(), 3u);
  EXPECT_EQ(sentences[0],
            "Hardest for the ego: diffusion in attack. Its CBVs touched the ego 8 times in 0.20 km "
            "(40.0 per km, 95 % [17.3, 78.8]).");
  EXPECT_NE(sentences[1].find(
                "pdm_lite driving naturally 0 times in 0.20 km (0.0 per km, 95 % [0.0, 18.4])"),
            std::string::npos)
      << sentences[1];
  EXPECT_EQ(
      sentences[2],
      "The first has more than all others, beyond chance (p <= 0.016 after Holm's correction).");
}

TEST(Ranking, SaysWhichDifferenceIsNotShown) {
  // 1 against 0 contacts: p = 1.
  const std::vector<std::string> sentences =
      sentencesOf({attacked("a", "pdm_lite", "naturalistic", 0.0),
                   attacked("a", "diffusion", "safety_critical", 1.0)});
  EXPECT_EQ(sentences.back(), "Not shown to be harder than pdm_lite.");
  EXPECT_NE(sentences[0].find("touched the ego 1 time in"), std::string::npos) << sentences[0];
}

TEST(Ranking, OfRunsWithoutCbvsSaysSo) {
  EXPECT_EQ(sentencesOf({test::recordWithout({}, "error")}),
            std::vector<std::string>{"No run is complete."});
  EXPECT_EQ(sentencesOf({test::recordWith({}, 1.0)}),
            std::vector<std::string>{"No CBV was driven, so nothing ranks the runs."});
}

TEST(HeatMap, HasACellForEachScenarioAndSystem) {
  std::vector<RunRecord> records = hardAndHarmless();
  records.push_back(test::recordWithout({"c", "1"}, "error"));
  records.back().factors = records[0].factors;
  records.back().factors["scenario"] = "c";
  const std::vector<System> systems = systemsOf(records);
  const SystemNames names(systems);
  const std::string html = heatMap(records, rankingOf(systems, records, names), names).str();
  // Most contacts per km first, most contacts first.
  EXPECT_NE(html.find("<th scope=\"col\">Scenario</th><th scope=\"col\">diffusion in attack</th>"),
            std::string::npos)
      << html;
  EXPECT_LT(html.find("<th scope=\"row\">b</th>"), html.find("<th scope=\"row\">a</th>"));
  EXPECT_NE(html.find("<td class=\"heat h4\"><a href=\"#runs\" data-filter=\"b · diffusion in "
                      "attack\"><b>5</b> contacts</a><small>1 at fault, score 75, 1 run</small>"),
            std::string::npos)
      << html;
  EXPECT_NE(html.find("<td class=\"heat\">not complete</td>"), std::string::npos);
}

}  // namespace
}  // namespace cdiff::evaluation
