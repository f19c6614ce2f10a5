// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/comparison.h"
#include "evaluation/matrix.h"
#include "evaluation/run_plan.h"
#include "evaluation/run_records.h"

namespace cdiff::evaluation {
namespace {

using test::recordWith;
using test::recordWithout;

TEST(Comparison, TakesDifferencesWithinPairs) {
  // Pairs (10, 11), (20, 22), (30, 33): differences 1, 2, 3 have s = 1 and t_{0.975, 2} = 4.302653,
  // however far apart the scenarios are. Seed 4 has no partner, seed 5 of B broke.
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
  ASSERT_EQ(comparison.measures.size(), 1U);
  const MeasureComparison& score = comparison.measures.front();
  EXPECT_EQ(score.measure, "ego_driving_score");
  EXPECT_DOUBLE_EQ(score.mean_a, 20.0);
  EXPECT_DOUBLE_EQ(score.mean_b, 22.0);
  EXPECT_EQ(score.difference.n, 3U);
  EXPECT_DOUBLE_EQ(*score.difference.mean, 2.0);
  EXPECT_NEAR(*score.difference.half_width, 4.302653 / std::sqrt(3.0), 1e-6);
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
  const auto comparisons = compareLevels(records, "guidance_profile", "none", {});
  ASSERT_EQ(comparisons.size(), 2U);
  EXPECT_EQ(comparisons[0].b, "guidance_profile area");
  EXPECT_EQ(comparisons[0].measures.front().difference.n, 1U);
  EXPECT_FALSE(comparisons[0].measures.front().difference.half_width.has_value());
  EXPECT_DOUBLE_EQ(*comparisons[1].measures.front().difference.mean, 4.0);  // of 3 and 5
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
  const auto comparisons = compareLevels(records, "mode", "naturalistic", {});
  ASSERT_EQ(comparisons.size(), 1U);
  EXPECT_EQ(comparisons[0].pairs, 30U);
  EXPECT_DOUBLE_EQ(*comparisons[0].measures.front().difference.mean, -8.0);
  EXPECT_EQ(comparisons[0].paired_by.count("guidance_profile"), 0U);
  EXPECT_NE(comparisonMarkdown(comparisons)
                .find("; guidance_profile follows (A naturalistic, B safety_critical)."),
            std::string::npos);
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
  const auto comparisons = compareLevels(records, "mode", "naturalistic", {});
  ASSERT_EQ(comparisons.size(), 1U);
  EXPECT_EQ(comparisons[0].pairs, 2U);
  EXPECT_TRUE(comparisons[0].followers.empty());
  // Scenarios and seeds say which runs belong together, whatever is compared.
  records[2].factors["seed"] = records[3].factors["seed"] = "2";
  EXPECT_EQ(compareLevels(records, "mode", "naturalistic", {})[0].pairs, 0U);
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
              compareLevels(records, "guidance_profil", "none", {});
            }).find("'guidance_profile'"),
            std::string::npos);
  EXPECT_NE(textOf([&] {
              compareLevels(records, "guidance_profile", "nine", {});
            }).find("the nearest is 'none'"),
            std::string::npos);
  EXPECT_NE(textOf([] { checkMeasureNames({"ego_driving_scores"}); }).find("'ego_driving_score'"),
            std::string::npos);
}

TEST(Comparison, WritesTables) {
  const RunSet a{"A", {recordWith({"s", "1"}, 10), recordWith({"s", "2"}, 20)}};
  const RunSet b{"B, new", {recordWith({"s", "1"}, 12), recordWith({"s", "2"}, 22)}};
  const std::vector<Comparison> comparisons = {compareRuns(a, b, sharedFactors(a, b), {})};
  EXPECT_NE(comparisonMarkdown(comparisons)
                .find("| ego_driving_score | 2 | 15.000 | 17.000 | 2.000 | [2.000, 2.000] |"),
            std::string::npos);
  EXPECT_NE(comparisonCsv(comparisons).find("A,\"B, new\",ego_driving_score,2,15,17,2,0,2,2\n"),
            std::string::npos);
}

}  // namespace
}  // namespace cdiff::evaluation
