// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "evaluation/batch_report.h"
#include "evaluation/heat_map.h"
#include "evaluation/ranking.h"
#include "evaluation/run_records.h"
#include "evaluation/system_names.h"

namespace cdiff::evaluation {
namespace {

/// A complete run of one CBV planner with contacts of the moving ego in 0.1 km as CBV, and others
/// of a standing one.
RunRecord attacked(const std::string& scenario, const std::string& planner, const std::string& mode,
                   double contacts, double standing = 0.0) {
  RunRecord record = test::recordWith({scenario, "1"}, 80.0 - contacts);
  record.factors["cbv_planner"] = planner;
  record.factors["mode"] = mode;
  record.factors["guidance_profile"] = mode;  // follows the mode
  record.id += planner + mode;
  record.measures["cbv_moving_ego_collisions"] = contacts;
  record.measures["cbv_ego_collisions"] = contacts + standing;
  record.measures["ego_collisions"] = contacts + standing;
  record.measures["ego_contacts_standing"] = standing;
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
  return rankingText(rankingOf(systems, records, names), names).sentences;
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
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
            "Hardest for the ego driven by pdm_lite: diffusion in attack. Its CBVs touched the "
            "moving ego 8 times in 0.20 km (40.0 per km, 95 % exact Poisson [17.3, 78.8]), and 0 "
            "times with the ego standing.");
  EXPECT_TRUE(has(sentences[1],
                  "pdm_lite driving naturally 0 times in 0.20 km (0.0 per km, 95 % exact Poisson "
                  "[0.0, 18.4]), and 0 times with the ego standing"))
      << sentences[1];
  EXPECT_EQ(
      sentences[2],
      "The first has more than all others, beyond chance (p <= 0.023 after Holm's correction).");
}

TEST(Ranking, SaysWhichDifferenceIsNotShown) {
  // 1 against 0 contacts: p = 1.
  const std::vector<std::string> sentences =
      sentencesOf({attacked("a", "pdm_lite", "naturalistic", 0.0),
                   attacked("a", "diffusion", "safety_critical", 1.0)});
  EXPECT_EQ(sentences.back(), "Not shown to be harder than pdm_lite.");
  EXPECT_TRUE(has(sentences[0], "touched the moving ego 1 time in")) << sentences[0];
}

// Variants with traffic of their own cannot be compared; the page names no difference.
TEST(Ranking, OfSystemsWithOtherInputsTellsNoDifference) {
  std::vector<RunRecord> records = {attacked("a", "pdm_lite", "naturalistic", 0.0),
                                    attacked("a", "diffusion", "safety_critical", 90.0)};
  records[0].inputs = {{"demand", "1"}};
  records[1].inputs = {{"demand", "2"}};
  EXPECT_EQ(sentencesOf(records).back(), "Not shown to be harder than pdm_lite.");
}

// 46 strikes on an ego in a jam against 6 on a moving one: the latter is harder.
TEST(Ranking, GoesByContactsOfTheMovingEgo) {
  std::vector<RunRecord> records = {attacked("a", "two_stage_pid", "safety_critical", 5.0, 46.0),
                                    attacked("a", "diffusion", "safety_critical", 6.0)};
  records[0].measures["ego_distance_m"] = records[1].measures["ego_distance_m"] = 1000.0;
  const std::vector<std::string> sentences = sentencesOf(records);
  EXPECT_TRUE(has(sentences[0], "pdm_lite: diffusion. Its CBVs touched the moving ego 6 times"))
      << sentences[0];
  EXPECT_TRUE(has(sentences[1], "two_stage_pid 5 times in 0.10 km (")) << sentences[1];
  EXPECT_TRUE(has(sentences[1], "and 46 times with the ego standing")) << sentences[1];
  // Scores are 75 and 74, faults 1 and 1 per km: both orders agree.
  EXPECT_FALSE(has(sentences.back(), "otherwise")) << sentences.back();
  records[0].measures["ego_contacts_at_fault"] = 3.0;
  records[0].measures["ego_driving_score"] = 20.0;
  EXPECT_EQ(sentencesOf(records).back(),
            "Other measures order them otherwise: contacts at the ego's fault per km "
            "(two_stage_pid 3.0, diffusion 1.0); driving score, lowest first (two_stage_pid 20.0, "
            "diffusion 74.0).");
}

TEST(Ranking, OfRecordsWithoutTheEgosMotionSaysSo) {
  std::vector<RunRecord> records = hardAndHarmless();
  for (RunRecord& record : records) record.measures.erase("cbv_moving_ego_collisions");
  const std::vector<std::string> sentences = sentencesOf(records);
  EXPECT_TRUE(has(sentences[0], "diffusion in attack. Its CBVs touched the ego 8 times in 0.20 km"))
      << sentences[0];
  EXPECT_EQ(sentences.back(), "These records do not say whether the ego moved.");
}

// Seven in a sentence, of more all but the first in a list.
TEST(Ranking, NamesEverySystem) {
  std::vector<RunRecord> records;
  const auto text = [&] {
    const std::vector<System> systems = systemsOf(records);
    const SystemNames names(systems);
    return rankingText(rankingOf(systems, records, names), names);
  };
  for (int i = 0; i < 8; ++i) {
    if (i == 7) {
      for (int named = 1; named < 7; ++named)
        EXPECT_TRUE(has(text().sentences[1], "planner" + std::to_string(6 - named) + " "));
      EXPECT_TRUE(text().folded.empty());
    }
    records.push_back(attacked("a", "planner" + std::to_string(i), "safety_critical", i));
  }
  EXPECT_EQ(text().sentences[1], "Then 7 others, listed below.");
  ASSERT_EQ(text().folded.size(), 7u);
  EXPECT_EQ(text().folded[6].rfind("planner0 0 times", 0), 0u);
}

TEST(Ranking, OfRunsWithoutCbvsSaysSo) {
  EXPECT_EQ(sentencesOf({test::recordWithout({}, "error")}),
            std::vector<std::string>{"No run is complete."});
  EXPECT_EQ(sentencesOf({test::recordWith({}, 1.0)}),
            std::vector<std::string>{"No CBV was driven, so nothing ranks the runs."});
}

// Red for what the ranking goes by: a jam that is struck is no hard scenario.
TEST(HeatMap, CountsAllContactsOfTheEgoAndSplitsThem) {
  std::vector<RunRecord> records = {attacked("a", "diffusion", "safety_critical", 0.0, 3.0),
                                    attacked("b", "diffusion", "safety_critical", 1.0)};
  records[1].measures["ego_collisions"] = 2.0;  // one with background traffic
  const std::vector<System> systems = systemsOf(records);
  const SystemNames names(systems);
  const std::string html = heatMap(records, rankingOf(systems, records, names), names).str();
  EXPECT_LT(html.find("<th scope=\"row\">b</th>"), html.find("<th scope=\"row\">a</th>"));
  EXPECT_TRUE(has(html,
                  "<b>3</b> contacts</a><small>3 with CBVs + 0 with background, 3 with the ego "
                  "standing; 0 at fault"))
      << html;
  EXPECT_TRUE(has(html, "<b>2</b> contacts</a><small>1 with CBVs + 1 with background; 0 at fault"))
      << html;
  EXPECT_TRUE(has(html, "<td class=\"heat h0\">")) << html;
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
                      "attack\"><b>5</b> contacts</a><small>5 with CBVs + 0 with background; 1 "
                      "at fault, score 75, 1 run</small>"),
            std::string::npos)
      << html;
  EXPECT_NE(html.find("<td class=\"heat\">not complete</td>"), std::string::npos);
}

std::string pageOf(const std::vector<RunRecord>& records) {
  std::vector<BatchRun> runs;
  for (const RunRecord& record : records) {
    runs.emplace_back();
    runs.back().record = record;
  }
  return batchPage("batch", runs, {}, {});
}

TEST(BatchPage, WarnsOfFewSeedsAndRoutesRightBelowTheAnswer) {
  const std::string page = pageOf(hardAndHarmless());
  const std::size_t answer = page.find("<div class=\"answer\"><p>Hardest for the ego");
  const std::size_t warning = page.find("<p class=\"few\">Warning: only 1 seed", answer);
  ASSERT_NE(warning, std::string::npos);
  EXPECT_EQ(page.find("<details", answer), page.find("<details", warning)) << "it is not folded";
  EXPECT_LT(warning, page.find("class=\"banner"));
  EXPECT_TRUE(has(page.substr(warning), "too few for bootstrap intervals, which need 5."));
}

TEST(BatchPage, SplitsTheContactsOfEachRun) {
  std::vector<RunRecord> records = {attacked("a", "diffusion", "safety_critical", 1.0, 2.0)};
  records[0].measures["ego_collisions"] = 4.0;
  const std::string page = pageOf(records);
  for (const char* heading : {">Contacts<", ">With CBVs<", ">With background<", ">Ego standing<"})
    EXPECT_TRUE(has(page, heading)) << heading;
  std::string cells;
  for (const char* count : {"4", "3", "1", "2"})
    cells += "<td class=\"number\">" + std::string(count) + "</td>";
  EXPECT_TRUE(has(page, cells)) << page;
}

}  // namespace
}  // namespace cdiff::evaluation
