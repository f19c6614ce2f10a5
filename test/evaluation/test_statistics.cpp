// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>

#include "evaluation/run_records.h"
#include "evaluation/statistics.h"

namespace cdiff::evaluation {
namespace {

using test::recordWith;
using test::recordWithout;

TEST(Statistics, OfThreeSamples) {
  // 1, 2, 3: s = 1; t_{0.975, 2} = 4.302653 (tables), half width 4.302653 / sqrt(3).
  const Statistics result = statisticsOf({1.0, 2.0, 3.0});
  EXPECT_EQ(result.n, 3U);
  EXPECT_DOUBLE_EQ(*result.mean, 2.0);
  EXPECT_DOUBLE_EQ(*result.standard_deviation, 1.0);
  EXPECT_NEAR(result.interval->high, 2.0 + 4.302653 / std::sqrt(3.0), 1e-6);
  EXPECT_NEAR(result.interval->low, 2.0 - 4.302653 / std::sqrt(3.0), 1e-6);
}

TEST(Statistics, SaysWhatTooFewSamplesCannotShow) {
  EXPECT_FALSE(statisticsOf({}).mean.has_value());
  const Statistics one = statisticsOf({5.0});
  EXPECT_DOUBLE_EQ(*one.mean, 5.0);
  EXPECT_FALSE(one.standard_deviation.has_value());
  EXPECT_FALSE(one.interval.has_value());
}

TEST(Cells, AverageRepetitionsBeforeSeeds) {
  // Seed 1: (10 + 20) / 2 = 15, seed 2: 25. Mean 20, deviation sqrt(50); all runs would give 18.3.
  const std::vector<Cell> cells =
      cellsOf({recordWith({"s", "1", "none", "1"}, 10.0), recordWith({"s", "1", "none", "2"}, 20.0),
               recordWith({"s", "2", "none", "1"}, 25.0)});
  ASSERT_EQ(cells.size(), 1U);
  const Statistics& score = cells.front().measures.at("ego_driving_score");
  EXPECT_EQ(score.n, 2U);
  EXPECT_DOUBLE_EQ(*score.mean, 20.0);
  EXPECT_DOUBLE_EQ(*score.standard_deviation, std::sqrt(50.0));
}

// 0 % of 900 samples and 100 % of 100.
TEST(Cells, PoolSharesAsTheirIntervalsDo) {
  RunRecord low = recordWith({"s", "1"}, 0.0);
  RunRecord high = recordWith({"s", "2"}, 0.0);
  low.measures = {{"cbv_off_road_percent", 0.0}, {"cbv_decisions", 900.0}};
  high.measures = {{"cbv_off_road_percent", 100.0}, {"cbv_decisions", 100.0}};
  EXPECT_DOUBLE_EQ(*cellsOf({low, high}).front().measures.at("cbv_off_road_percent").mean, 10.0);
}

TEST(Cells, CountEveryRunWhateverItsOutcome) {
  const std::vector<Cell> cells =
      cellsOf({recordWith({"s", "1"}, 10.0), recordWithout({"s", "2"}, "error"),
               recordWithout({"s", "3"}, "not_run"), recordWithout({"s", "4"}, "interrupted"),
               recordWith({"t", "1"}, 30.0)});
  ASSERT_EQ(cells.size(), 2U);
  EXPECT_EQ(cells[0].factors.at("scenario"), "s");
  EXPECT_EQ(cells[0].factors.count("seed"), 0U);
  EXPECT_EQ(cells[0].runs, 4U);
  EXPECT_EQ(cells[0].failed, 1U);
  EXPECT_EQ(cells[0].missing, 2U);
  EXPECT_EQ(cells[0].measures.at("ego_driving_score").n, 1U);
  EXPECT_EQ(cells[1].runs, 1U);
}

}  // namespace
}  // namespace cdiff::evaluation
