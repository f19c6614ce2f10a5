// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "evaluation/remaining_time.h"
#include "evaluation/run_order.h"

namespace cdiff::evaluation {
namespace {

/// A run with the time that it takes.
struct TimedRun {
  PlannedRun run;
  double seconds = 0.0;
};

/// 20 scenarios of 1 to 4 s x planners that take 1, 3 and 9 times as long x 5 seeds that vary by 20
/// %, scenarios outermost as in every plan.
std::vector<TimedRun> batch() {
  std::vector<TimedRun> runs;
  const std::pair<const char*, double> planners[] = {{"fast", 1.0}, {"medium", 3.0}, {"slow", 9.0}};
  for (int scenario = 0; scenario < 20; ++scenario) {
    for (const auto& [planner, factor] : planners) {
      for (int seed = 0; seed < 5; ++seed) {
        TimedRun timed;
        for (const std::string& name : factorNames()) timed.run.factors[name] = "x";
        timed.run.factors["scenario"] = "s" + std::to_string(scenario);
        timed.run.factors["cbv_planner"] = planner;
        timed.run.factors["seed"] = std::to_string(seed);
        timed.run.id = "s" + std::to_string(scenario) + planner + std::to_string(seed);
        timed.seconds = (1.0 + 3.0 * scenario / 19.0) * factor * (0.8 + 0.1 * seed);
        runs.push_back(timed);
      }
    }
  }
  return runs;
}

/// Ratio of the time that is said to be left after a tenth of the runs to the one that is, with one
/// process at a time.
double ratioAfterATenth(const std::vector<TimedRun>& runs) {
  std::vector<PlannedRun> plan;
  for (const TimedRun& timed : runs) plan.push_back(timed.run);
  RemainingTime remaining(plan, 1);
  double elapsed = 0.0;
  double left = 0.0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (i >= runs.size() / 10) {
      left += runs[i].seconds;
      continue;
    }
    elapsed += runs[i].seconds;
    remaining.ended(runs[i].run.id, runs[i].seconds);
  }
  return remaining.left(elapsed) / left;
}

TEST(RemainingTime, IsRightAfterATenthOfABatch) {
  std::vector<TimedRun> runs = batch();
  // In the plan's order a tenth are the two shortest scenarios.
  EXPECT_LT(ratioAfterATenth(runs), 0.7);
  std::vector<PlannedRun> plan;
  for (const TimedRun& timed : runs) plan.push_back(timed.run);
  std::vector<TimedRun> ordered;
  for (const std::size_t index : runOrder(plan)) ordered.push_back(runs[index]);
  runs = ordered;
  EXPECT_NEAR(ratioAfterATenth(runs), 1.0, 0.3);
}

TEST(RunOrder, LetsSystemsTakeTurnsThroughAllScenarios) {
  std::vector<PlannedRun> plan;
  for (const TimedRun& timed : batch()) plan.push_back(timed.run);
  const std::vector<std::size_t> order = runOrder(plan);
  ASSERT_EQ(std::set<std::size_t>(order.begin(), order.end()).size(), 300u);
  for (std::size_t turn = 0; turn < order.size(); turn += 3) {  // three systems
    std::set<std::string> systems;
    for (std::size_t i = turn; i < turn + 3; ++i)
      systems.insert(plan[order[i]].factors.at("cbv_planner"));
    EXPECT_EQ(systems.size(), 3u) << turn;
  }
  std::map<std::string, std::set<std::string>> scenarios;  // of the first 60 runs
  for (std::size_t i = 0; i < 60; ++i)
    scenarios[plan[order[i]].factors.at("cbv_planner")].insert(
        plan[order[i]].factors.at("scenario"));
  for (const auto& [planner, seen] : scenarios) EXPECT_EQ(seen.size(), 20u) << planner;
}

TEST(RemainingTime, CountsWhatRunsUnderWayHaveBehindThem) {
  std::vector<PlannedRun> plan(4);
  for (std::size_t i = 0; i < plan.size(); ++i) {
    plan[i].id = std::to_string(i);
    for (const std::string& name : factorNames()) plan[i].factors[name] = "x";
  }
  RemainingTime remaining(plan, 2);
  EXPECT_DOUBLE_EQ(remaining.left(5.0), 0.0);  // nothing is known
  remaining.ended("0", 10.0);
  // After 10 s the second process has 10 s behind it, of which at most half a run counts: 30 - 5.
  EXPECT_DOUBLE_EQ(remaining.left(10.0), 25.0 / 2.0);
  remaining.ended("1", std::nullopt);  // was there before
  remaining.ended("2", 10.0);
  remaining.ended("3", 10.0);
  EXPECT_DOUBLE_EQ(remaining.left(20.0), 0.0);
}

}  // namespace
}  // namespace cdiff::evaluation
