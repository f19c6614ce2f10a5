// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "record/logs/planner_logs.h"

namespace cdiff::record {
namespace {

TEST(LatencyLog, GivesNearestRanksPerPlanner) {
  LatencyLog log;
  // 1 to 20 ms in falling order: rank ceil(0.50 * 20) = 10 -> 10 ms, ceil(0.95 * 20) = 19 -> 19 ms.
  for (int i = 20; i >= 1; --i) log.observe({{"ego:a", static_cast<double>(i)}});
  log.observe({{"cbv:b", 4.0}});
  const auto summaries = log.summaries();
  ASSERT_EQ(summaries.size(), 2u);
  EXPECT_EQ(summaries.at("ego:a").median, 10.0);
  EXPECT_EQ(summaries.at("ego:a").percentile_95, 19.0);
  EXPECT_EQ(summaries.at("ego:a").maximum, 20.0);
  EXPECT_EQ(summaries.at("ego:a").n, 20u);
  EXPECT_EQ(summaries.at("cbv:b").median, 4.0);
  EXPECT_EQ(summaries.at("cbv:b").percentile_95, 4.0);
}

TEST(LateLog, CountsWhatCameLateOrNeverAndWhatDroveInstead) {
  using Timing = session::AnswerTiming;
  LateLog log;
  log.observe({{"cbv:a", true, 0.0, Timing::Instead::kPlan},  // in time: nothing was replaced
               {"cbv:a", true, 0.2, Timing::Instead::kPlan},
               {"cbv:a", true, 0.1, Timing::Instead::kFullBrake},
               {"cbv:a", false, 0.0, Timing::Instead::kNotDriven},
               {"ego:b", true, 0.0, Timing::Instead::kNothing}});
  const auto counts = log.counts();
  const LateCounts& late = counts.at("cbv:a");
  EXPECT_EQ(late.asked, 4u);
  EXPECT_EQ(late.late, 2u);
  EXPECT_EQ(late.missing, 1u);
  EXPECT_EQ(late.by_plan, 1u);
  EXPECT_EQ(late.by_full_brake, 1u);
  EXPECT_EQ(late.not_driven, 1u);
  EXPECT_EQ(late.median, 0.1);  // rank ceil(0.5 * 2) = 1
  EXPECT_EQ(late.maximum, 0.2);
  EXPECT_EQ(counts.at("ego:b").asked, 1u);
  EXPECT_EQ(lateAnswers(counts), 3u);
  EXPECT_EQ(latenessText(counts),  // 3 of 5
            "3 of 5 (60.0 %); instead drove the last plan's next action 1 times, full braking 1 "
            "times");
  EXPECT_EQ(latenessText({}), "");
}

}  // namespace
}  // namespace cdiff::record
