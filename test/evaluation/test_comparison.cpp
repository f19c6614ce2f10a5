// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/comparison/comparison.h"
#include "evaluation/comparison/comparison_text.h"
#include "evaluation/matrix.h"
#include "evaluation/run_plan.h"
#include "evaluation/run_records.h"
#include "support/error_text.h"

namespace cdiff::evaluation {
namespace {

using test::recordWith;
using test::recordWithout;

TEST(Comparison, TakesDifferencesWithinPairs) {
  // Pairs (10, 11), (20, 22) of s, (30, 33) of t: mean differences 1.5 and 3, of all pairs 2. Two
  // routes: replicates are s twice, both, t twice, so the interval is 1.5 to 3. Seed 4 has no
  // partner, seed 5 of B broke.
  const RunSet a{
      "A",
      {recordWith({"s", "1"}, 10), recordWith({"s", "2"}, 20), recordWith({"t", "1"}, 30),
       recordWith({"s", "4"}, 99), recordWith({"s", "5"}, 99)}};
  const RunSet b{"B",
                 {recordWith({"t", "1"}, 33), recordWith({"s", "1"}, 11),
                  recordWith({"s", "2"}, 22), recordWithout({"s", "5"}, "error")}};
  const Comparison comparison = compareRuns(a, b, sharedFactors(a, b), {});
  EXPECT_EQ(comparison.pairs, 3U);
  EXPECT_EQ(comparison.runs_a, 5U);
  EXPECT_EQ(comparison.runs_b, 4U);
  EXPECT_EQ(comparison.clusters, 2U);
  EXPECT_EQ(comparison.seeds, 2U);
  ASSERT_EQ(comparison.measures.size(), 1U);
  const MeasureComparison& score = comparison.measures.front();
  EXPECT_EQ(score.measure, "ego_driving_score");
  EXPECT_DOUBLE_EQ(*score.a.value, 20.0);
  EXPECT_DOUBLE_EQ(*score.b.value, 22.0);
  EXPECT_EQ(score.pairs, 3U);
  EXPECT_DOUBLE_EQ(*score.difference, 2.0);
  EXPECT_DOUBLE_EQ(score.interval->low, 1.5);
  EXPECT_DOUBLE_EQ(score.interval->high, 3.0);
  EXPECT_DOUBLE_EQ(score.p, 0.5);  // of 4 ways to exchange A and B, 2 are as large
}

/// Contacts with the ego on each of some routes of 1 km as CBV.
RunSet contactsOf(const std::string& name, const std::vector<double>& contacts) {
  RunSet set{name, {}};
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    set.records.push_back(recordWithout({"route" + std::to_string(i), "1"}, "completed"));
    set.records.back().measures = {{"cbv_ego_collisions", contacts[i]}, {"cbv_distance_m", 1000.0}};
  }
  return set;
}

TEST(Comparison, TestsCountsExactly) {
  // 0 against 5 on equal km: p = 2 / 2^5. Garwood's 0 to 3.6889 and 1.6235 to 11.6683 over 5 km;
  // routes that are all alike have no bootstrap.
  const RunSet a = contactsOf("A", {0, 0, 0, 0, 0});
  const RunSet b = contactsOf("B", {1, 1, 1, 1, 1});
  auto comparisons =
      std::vector{compareRuns(a, b, sharedFactors(a, b), {"cbv_ego_collisions", "cbv_distance_m"})};
  adjustForNumber(comparisons);
  const MeasureComparison& contacts = comparisons[0].measures.front();
  EXPECT_EQ(contacts.b.events, 5U);
  EXPECT_DOUBLE_EQ(contacts.b.exposure, 5.0);
  EXPECT_NEAR(contacts.p, 2.0 / 32.0, 1e-12);
  EXPECT_NEAR(contacts.p_holm, 4.0 / 32.0, 1e-12);  // of two comparisons
  const std::string text = comparisonMarkdown(comparisons);
  EXPECT_NE(text.find("| 0 / 5.000 km = 0.000 [0.000, 0.738] | 5 / 5.000 km = 1.000 [0.325, "
                      "2.334] |"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("5 pairs of 5 runs of A and 5 of B: 5 routes x 1 seed;"), std::string::npos);
  EXPECT_EQ(text.find("A row shows"), std::string::npos);
  EXPECT_NE(text.find("Warning: only 1 seed;"), std::string::npos);
  EXPECT_NE(text.find("Multiplicity: of 2 differences tested here, 0 have p <= 0.05, where about "
                      "0.1 would by chance"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("With 5 routes no p of a mean is below 0.0625, so"), std::string::npos)
      << text;
}

TEST(Comparison, NamesTheDifferencesThatStay) {
  const RunSet a = contactsOf("A", {0, 0, 0, 0, 0, 0, 0, 0});
  const RunSet b = contactsOf("B", {2, 2, 2, 2, 2, 2, 2, 2});
  auto comparisons =
      std::vector{compareRuns(a, b, sharedFactors(a, b), {"cbv_ego_collisions", "cbv_distance_m"})};
  adjustForNumber(comparisons);
  const std::string text = comparisonMarkdown(comparisons);
  EXPECT_NE(text.find("1 stay after Holm's correction for their number: cbv_ego_collisions.\n"),
            std::string::npos)
      << text;
  EXPECT_EQ(text.find("no p of a mean"), std::string::npos) << text;
}

// Of 11 routes 11 contacts against none: p = 2 / 2^11 = 0.00098, five times that among the headline
// measures; among 60 measures it would be 0.06.
TEST(Comparison, CorrectsHeadlineMeasuresAmongThemselves) {
  RunSet a = contactsOf("A", std::vector<double>(11, 0.0));
  RunSet b = contactsOf("B", std::vector<double>(11, 1.0));
  for (RunSet* set : {&a, &b}) {
    for (RunRecord& record : set->records) {
      for (const std::string& name : measureNames()) record.measures.emplace(name, 1.0);
    }
  }
  auto comparisons = std::vector{compareRuns(a, b, sharedFactors(a, b), {})};
  adjustForNumber(comparisons);
  ASSERT_EQ(comparisons[0].measures.size(), measureNames().size());
  const MeasureComparison& contacts = comparisons[0].measures.front();
  EXPECT_EQ(contacts.measure, "cbv_ego_collisions");
  EXPECT_NEAR(contacts.p_holm, 5.0 * 2.0 / 2048.0, 1e-9);
  EXPECT_EQ(multiplicityOf(comparisons, true).differences, 5U);
  const std::string text = comparisonMarkdown(comparisons);
  EXPECT_NE(text.find("| ego_driving_score |"), std::string::npos) << text;
  EXPECT_EQ(text.find("ttc_mean_s"), std::string::npos) << text;
  EXPECT_NE(text.find("further differences: --all shows them"), std::string::npos) << text;
  EXPECT_NE(comparisonMarkdown(comparisons, true).find("| ttc_mean_s |"), std::string::npos);
  EXPECT_NE(comparisonCsv(comparisons).find(",headline\n"), std::string::npos);
}

TEST(Comparison, OfFewRoutesShowsNoIntervalInAnyColumn) {
  // On 2 routes counts, means and differences have intervals; on 1 route counts alone would.
  RunSet a = contactsOf("A", {0, 1});
  RunSet b = contactsOf("B", {3, 5});
  for (RunSet* set : {&a, &b}) {
    for (RunRecord& record : set->records) record.measures["ttc_mean_s"] = 2.0;
  }
  const auto comparisons = std::vector{compareRuns(a, b, sharedFactors(a, b), {})};
  const std::string text = comparisonMarkdown(comparisons);
  EXPECT_NE(text.find("| measure | pairs | kind | A | B | B - A | B / A | p | p (Holm) | note |"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("| 1 / 2.000 km = 0.500 | 8 / 2.000 km = 4.000 | 3.500 | 8.00 |"),
            std::string::npos)
      << text;
  EXPECT_EQ(text.find("interval by"), std::string::npos) << text;
  EXPECT_NE(text.find("A row shows the intervals of all its figures or none: it needs 5 routes."),
            std::string::npos)
      << text;
}

TEST(Comparison, BelievesOverDispersedCountsLess) {
  // 12 contacts on one of three routes: exactly 2 / 2^12, but by routes 1.
  const RunSet a = contactsOf("A", {0, 0, 0});
  const RunSet b = contactsOf("B", {12, 0, 0});
  const Comparison comparison = compareRuns(a, b, sharedFactors(a, b), {"cbv_ego_collisions"});
  const MeasureComparison& contacts = comparison.measures.front();
  EXPECT_NEAR(contacts.rates->p, 2.0 / 4096.0, 1e-12);
  EXPECT_DOUBLE_EQ(contacts.p, 1.0);
}

using test::errorOf;

RunSet drivenBy(const std::string& name, const std::string& suite, const std::string& time_limit) {
  RunSet set{name, {recordWith({"s", "1"}, 10)}};
  set.conditions.suite = suite;
  set.conditions.protocols[set.records[0].id] = {
      "rift_dev10, time limit " + time_limit + " s",
      {{"preset", "\"rift_dev10\""}, {"time_limit", time_limit}}};
  return set;
}

TEST(Comparison, RefusesOtherProtocols) {
  const RunSet a = drivenBy("A", "test", "40");
  EXPECT_EQ(errorOf([&] { requireComparable(a, drivenBy("B", "test", "40")); }), "no error");
  const std::string refusal = errorOf([&] {
    compareRuns(a, drivenBy("B", "test", "60"), {"scenario", "seed"}, {});
  });
  for (const char* part : {"different protocols", "scenario 's'", "time_limit 40 in A and 60 in B",
                           "Run one of them again"})
    EXPECT_NE(refusal.find(part), std::string::npos) << refusal;
}

TEST(Comparison, RefusesOtherSuites) {
  const std::string refusal = errorOf(
      [] { requireComparable(drivenBy("A", "test", "40"), drivenBy("B", "sealed_a", "40")); });
  for (const char* part : {"other routes", "suite 'test' and suite 'sealed_a'", "Run one of them"})
    EXPECT_NE(refusal.find(part), std::string::npos) << refusal;
}

TEST(Comparison, RefusesAScenarioWithAnotherNetwork) {
  RunSet a = drivenBy("A", "", "40");
  RunSet b = drivenBy("B", "", "40");
  a.records[0].inputs = {{"network", "11"}, {"program", "1"}};
  b.records[0].inputs = {{"network", "11"}, {"program", "2"}};
  EXPECT_EQ(errorOf([&] { requireComparable(a, b); }), "no error");
  b.records[0].inputs["network"] = "22";
  EXPECT_NE(errorOf([&] { requireComparable(a, b); }).find("its network is not the same"),
            std::string::npos);
  b.records[0].inputs = {{"network", "11"}, {"demand", "3"}, {"program", "2"}};
  EXPECT_NE(errorOf([&] { requireComparable(a, b); }).find("its demand is not the same"),
            std::string::npos)
      << "only one side has a demand file";
}

TEST(Comparison, PairsByWhatBothSetsShare) {
  // Profiles differ between the sets, so they are what is compared; everything else pairs.
  const RunSet a{"A", {recordWith({"s", "1", "none"}, 10)}};
  const RunSet b{"B", {recordWith({"s", "1", "naturalistic"}, 12)}};
  const std::set<std::string> shared = sharedFactors(a, b);
  EXPECT_EQ(shared.count("guidance_profile"), 0U);
  EXPECT_EQ(shared.count("cbv_planner"), 1U);
  EXPECT_EQ(compareRuns(a, b, shared, {}).pairs, 1U);
  const RunSet both{"C", {recordWith({"s", "1", "none"}, 10), b.records.front()}};
  EXPECT_EQ(sharedFactors(a, both).count("guidance_profile"), 1U);
}

TEST(Comparison, PairsALevelWithItsBaseline) {
  const std::vector<RunRecord> records = {
      recordWith({"s", "1", "none"}, 10), recordWith({"s", "2", "none"}, 20),
      recordWith({"s", "1", "speed"}, 13), recordWith({"s", "2", "speed"}, 25),
      recordWith({"s", "2", "area"}, 21)};
  const auto comparisons = compareLevels({"A", records}, "guidance_profile", "none", {});
  ASSERT_EQ(comparisons.size(), 2U);
  EXPECT_EQ(comparisons[0].b, "guidance_profile area");
  EXPECT_EQ(comparisons[0].measures.front().pairs, 1U);
  EXPECT_FALSE(comparisons[0].measures.front().interval.has_value());
  EXPECT_DOUBLE_EQ(*comparisons[1].measures.front().difference, 4.0);  // of 3 and 5
}

/// Runs of a matrix as if all had been driven, those of `mode` with a score `gain` above 50.
std::vector<RunRecord> drivenRuns(const std::string& matrix, const std::string& mode, double gain) {
  std::vector<RunRecord> records;
  for (const PlannedRun& run : planRuns(loadMatrix(matrix), matrix)) {
    records.push_back(recordOf(run));
    records.back().status = "completed";
    records.back().measures["ego_driving_score"] =
        50.0 + (run.factors.at("mode") == mode ? gain : 0.0);
  }
  return records;
}

TEST(Comparison, AFactorThatFollowsTheComparedOneDoesNotPair) {
  // 10 scenarios x 3 seeds in 2 modes, each mode with the guidance profile of its name: 30 pairs.
  const auto records = drivenRuns("development", "safety_critical", -8.0);
  const auto comparisons = compareLevels({"A", records}, "mode", "naturalistic", {});
  ASSERT_EQ(comparisons.size(), 1U);
  EXPECT_EQ(comparisons[0].pairs, 30U);
  EXPECT_DOUBLE_EQ(*comparisons[0].measures.front().difference, -8.0);
  EXPECT_EQ(comparisons[0].paired_by.count("guidance_profile"), 0U);
  EXPECT_NE(comparisonMarkdown(comparisons)
                .find("; guidance_profile follows (A naturalistic, B safety_critical)."),
            std::string::npos);
}

TEST(Comparison, AFactorThatSeveralOthersDetermineDoesNotPair) {
  // Both methods in both modes, each with a profile of its own: 10 scenarios x 5 seeds x 2.
  const auto records = drivenRuns("main_rows", "safety_critical", -8.0);
  for (const auto& [factor, baseline] :
       {std::pair{"method", "default"}, std::pair{"mode", "naturalistic"}}) {
    const auto comparisons = compareLevels({"A", records}, factor, baseline, {});
    ASSERT_EQ(comparisons.size(), 1U) << factor;
    EXPECT_EQ(comparisons[0].pairs, 100U) << factor;
    EXPECT_DOUBLE_EQ(*comparisons[0].measures.front().difference,
                     std::string(factor) == "mode" ? -8.0 : 0.0);
    EXPECT_EQ(comparisons[0].followers.count("guidance_profile"), 1U) << factor;
  }
}

TEST(Comparison, AFactorWithSeveralLevelsPairs) {
  // Seed 1 drove both profiles in both modes: the profile does not follow, so profiles pair.
  std::vector<RunRecord> records;
  for (const char* mode : {"naturalistic", "safety_critical"}) {
    for (const char* profile : {"none", "naturalistic"}) {
      records.push_back(recordWith({"s", "1", profile}, profile[1] == 'o' ? 10 : 30));
      records.back().factors["mode"] = mode;
    }
  }
  const auto comparisons = compareLevels({"A", records}, "mode", "naturalistic", {});
  ASSERT_EQ(comparisons.size(), 1U);
  EXPECT_EQ(comparisons[0].pairs, 2U);
  EXPECT_TRUE(comparisons[0].followers.empty());
  // Scenarios and seeds say which runs belong together, whatever is compared.
  records[2].factors["seed"] = records[3].factors["seed"] = "2";
  EXPECT_EQ(compareLevels({"A", records}, "mode", "naturalistic", {})[0].pairs, 0U);
}

TEST(Comparison, NamesTheNearestOfWhatItDoesNotKnow) {
  const std::vector<RunRecord> records = {recordWith({"s", "1", "none"}, 10)};
  const auto textOf = [](const std::function<void()>& call) -> std::string {
    try {
      call();
    } catch (const core::InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(textOf([&] {
              compareLevels({"A", records}, "guidance_profil", "none", {});
            }).find("'guidance_profile'"),
            std::string::npos);
  EXPECT_NE(textOf([&] {
              compareLevels({"A", records}, "guidance_profile", "nine", {});
            }).find("the nearest is 'none'"),
            std::string::npos);
  EXPECT_NE(textOf([] {
              checkMeasureNames({"ego_driving_score", "ego_driving_score"});
            }).find("is there twice"),
            std::string::npos);
  EXPECT_NE(textOf([] { checkMeasureNames({"ego_driving_scores"}); }).find("'ego_driving_score'"),
            std::string::npos);
}

TEST(Comparison, WritesTables) {
  // Route s 10 and 12, t 20 and 26: differences 2 and 6. The file holds the intervals, too.
  const RunSet a{"A", {recordWith({"s", "1"}, 10), recordWith({"t", "1"}, 20)}};
  const RunSet b{"B, new", {recordWith({"s", "1"}, 12), recordWith({"t", "1"}, 26)}};
  std::vector<Comparison> comparisons = {compareRuns(a, b, sharedFactors(a, b), {})};
  adjustForNumber(comparisons);
  const std::string markdown = comparisonMarkdown(comparisons);
  EXPECT_NE(markdown.find("| ego_driving_score | 2 | mean | 15.000 | 19.000 | 4.000 | - | 0.500 | "
                          "0.500 |"),
            std::string::npos)
      << markdown;
  const std::string csv = comparisonCsv(comparisons);
  EXPECT_NE(csv.find("A,\"B, new\",ego_driving_score,mean,2,2,1,15,10,20,bootstrap,,,,,,19,12,26,"
                     "bootstrap,,,,,,4,2,6,bootstrap,,,,0.5,0.5,0.5,headline\n"),
            std::string::npos)
      << csv;
}

}  // namespace
}  // namespace cdiff::evaluation
