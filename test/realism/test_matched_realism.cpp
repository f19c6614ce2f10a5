// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>

#include "core/file.h"
#include "core/scratch_folder.h"
#include "e2e_cdiff/core/exceptions.h"
#include "realism/matched_realism.h"
#include "realism/realism_tables.h"

namespace cdiff::realism {
namespace {

evaluation::PlannedRun run(const std::string& scenario, const std::string& planner,
                           const std::string& variant = "") {
  evaluation::PlannedRun run;
  run.id = scenario + "__" + planner + variant;
  run.factors = {{"scenario", scenario},   {"ego_planner", "pdm_lite"}, {"cbv_planner", planner},
                 {"mode", "naturalistic"}, {"variant", variant},        {"seed", "1"}};
  run.scenario_sha256 = "0";
  return run;
}

/// A score with a speed and a collision likelihood: (w .05 x speed + w .25 x collision) / .30.
MatchedEnd ended(double speed, double collision, std::uint64_t tick = 40) {
  MatchedEnd end;
  end.score.emplace();
  end.score->hand_over_tick = tick;
  end.score->objects = {"b"};
  end.score->log_steps = 80;
  end.score->sums[kLinearSpeed].add(std::log(speed));
  end.score->sums[kCollision].add(std::log(collision));
  return end;
}

TEST(MatchedPlan, AddsSumoOnceForEachSession) {
  const auto jobs = planMatched(
      {run("a", "pdm_lite"), run("a", "diffusion"), run("b", "diffusion", "paper")}, {});
  ASSERT_EQ(jobs.size(), 5U);
  EXPECT_EQ(jobs[0].driver, "SUMO background");
  EXPECT_TRUE(jobs[0].planner.empty());
  EXPECT_EQ(jobs[1].driver, "PDM-Lite, naturalistic");
  EXPECT_EQ(jobs[3].run.id, "b__seed1__sumo");
  EXPECT_EQ(jobs[4].driver, "paper");
  auto by_paper = run("a", "diffusion");
  by_paper.factors["method"] = "paper";
  const auto two = planMatched({run("a", "diffusion"), by_paper, run("a", "pdm_lite")}, {});
  EXPECT_NE(two[1].driver, two[2].driver) << "two methods are two rows";
  EXPECT_EQ(two[2].driver.substr(two[2].driver.size() - 14), ", method paper");
  EXPECT_EQ(two[3].driver, "PDM-Lite, naturalistic") << "and no other name changes";
  const auto alike = planMatched({run("a b", "pdm_lite"), run("a_b", "pdm_lite")}, {});
  EXPECT_NE(alike[0].run.id, alike[2].run.id);
  auto other = run("c", "diffusion");
  other.factors["ego_planner"] = "diffusion";
  EXPECT_THROW(planMatched({run("a", "pdm_lite"), other}, {}), core::InputError);
}

TEST(MatchedRows, AverageOverScenariosAndNameTheCeiling) {
  const std::vector<MatchedJob> jobs = {{"PDM-Lite", "pdm_lite", run("a", "pdm_lite")},
                                        {"mine", "diffusion", run("a", "diffusion")},
                                        {"PDM-Lite", "pdm_lite", run("b", "pdm_lite")},
                                        {"mine", "diffusion", run("b", "diffusion")}};
  MatchedEnd without;
  without.score.emplace();
  const auto rows =
      matchedRows(jobs, {ended(0.6, 0.9), ended(0.3, 0.6), without, {{}, "exit code 2"}});
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_TRUE(rows[0].ceiling);
  EXPECT_FALSE(rows[1].ceiling);
  EXPECT_EQ(rows[0].hand_overs, 1U);
  EXPECT_EQ(rows[0].without, 1U);
  EXPECT_EQ(rows[1].broken, 1U);
  EXPECT_NEAR(rows[0].meta.mean.value(), (0.05 * 0.6 + 0.25 * 0.9) / 0.3, 1e-12);
  EXPECT_NEAR(rows[1].likelihoods[kCollision].value(), 0.6, 1e-12);
  EXPECT_NE(matchedMarkdown(rows, {}).find("PDM-Lite (ceiling) | 0.850"), std::string::npos);
  EXPECT_NE(matchedJson(rows, {}).find("\"sessions_without_cbv\": 1"), std::string::npos);
  EXPECT_NE(matchedPage(rows, {}).find("Evaluated objects: the CBVs"), std::string::npos);
}

TEST(MatchedRows, RefuseDriversWithDifferentHandOvers) {
  const std::vector<MatchedJob> jobs = {{"PDM-Lite", "pdm_lite", run("a", "pdm_lite")},
                                        {"mine", "diffusion", run("a", "diffusion")}};
  EXPECT_THROW(matchedRows(jobs, {ended(0.6, 0.9, 40), ended(0.6, 0.9, 42)}), core::InputError);
}

TEST(MatchedScore, ReadsBackWhatWasWritten) {
  const core::ScratchFolder folder;
  const auto file = folder.path() / "score.json";
  const ContinuationScore score = *ended(0.6, 0.9).score;
  core::writeFileAtomically(file, scoreJson(score));
  const ContinuationScore read = readScore(file);
  EXPECT_EQ(read.hand_over_tick, score.hand_over_tick);
  EXPECT_EQ(read.objects, score.objects);
  EXPECT_EQ(read.sums[kCollision].log_sum, score.sums[kCollision].log_sum);
  EXPECT_EQ(read.sums[kCollision].n, 1U);
  core::writeFileAtomically(file, scoreJson({}));
  EXPECT_FALSE(readScore(file).hand_over_tick.has_value());
  core::writeFileAtomically(file, "{}");
  EXPECT_THROW(readScore(file), core::InputError);
}

}  // namespace
}  // namespace cdiff::realism
