// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>

#include "evaluation/intervals/pooled_estimate.h"
#include "evaluation/run_records.h"
#include "metrics/metric_registry.h"

namespace cdiff::evaluation {
namespace {

using test::recordWithout;

RunRecord runOf(const std::string& route, const std::string& seed, const Measures& measures) {
  RunRecord record = recordWithout({route, seed}, "completed");
  record.measures = measures;
  record.simulated_seconds = 10.0;
  return record;
}

PooledEstimate estimateOf(const std::vector<RunRecord>& records, const std::string& measure) {
  std::vector<const RunRecord*> runs;
  for (const RunRecord& record : records) runs.push_back(&record);
  RouteBootstrap bootstrap;
  return pooledEstimate(runs, measure, bootstrap);
}

TEST(PooledEstimate, OfACountIsItsRatePerKilometer) {
  // 3 contacts in 0.5 + 1.5 km of CBVs: 1.5 per km, Garwood 0.6187 to 8.7673 over 2 km.
  const PooledEstimate estimate =
      estimateOf({runOf("a", "1", {{"cbv_collisions", 2}, {"cbv_distance_m", 500}}),
                  runOf("b", "1", {{"cbv_collisions", 1}, {"cbv_distance_m", 1500}})},
                 "cbv_collisions");
  EXPECT_EQ(estimate.events, 3U);
  EXPECT_DOUBLE_EQ(estimate.exposure, 2.0);
  EXPECT_DOUBLE_EQ(*estimate.value, 1.5);
  EXPECT_NEAR(estimate.interval->low, 0.6187 / 2.0, 1e-4);
  EXPECT_NEAR(estimate.interval->high, 8.7673 / 2.0, 1e-4);
  EXPECT_EQ(estimate.interval_kind, IntervalKind::kPoisson);
  // Expected 0.75 and 2.25: (1.25^2 / 0.75 + 1.25^2 / 2.25) / 1 = 2.78, below chi2(0.95; 1) = 3.84.
  EXPECT_NEAR(*estimate.dispersion, 2.7778, 1e-4);
  EXPECT_FALSE(estimate.over_dispersed);
  EXPECT_EQ(estimateText(estimate, 2, true), "3 / 2.000 km = 1.50 [0.31, 4.38]");
  EXPECT_EQ(estimateText(estimate, 2, false), "3 / 2.000 km = 1.50");
}

TEST(PooledEstimate, OfARateCountsItsEvents) {
  // 4 per km on 0.5 km and none on 1.5 km: 2 events in 2 km.
  const PooledEstimate estimate =
      estimateOf({runOf("a", "1", {{"cbv_collisions_per_km", 4}, {"cbv_distance_m", 500}}),
                  runOf("b", "1", {{"cbv_collisions_per_km", 0}, {"cbv_distance_m", 1500}})},
                 "cbv_collisions_per_km");
  EXPECT_EQ(estimate.events, 2U);
  EXPECT_DOUBLE_EQ(*estimate.value, 1.0);
}

TEST(PooledEstimate, OfNoEventHasAnUpperLimit) {
  const PooledEstimate estimate = estimateOf(
      {runOf("a", "1", {{"cbv_collisions", 0}, {"cbv_distance_m", 4000}})}, "cbv_collisions");
  EXPECT_DOUBLE_EQ(estimate.interval->low, 0.0);
  EXPECT_NEAR(estimate.interval->high, -std::log(0.025) / 4.0, 1e-12);
}

TEST(PooledEstimate, EventsOfAStandingVehicleCount) {
  const PooledEstimate estimate =
      estimateOf({runOf("a", "1", {{"ego_collisions", 1}, {"ego_distance_m", 0}}),
                  runOf("b", "1", {{"ego_collisions", 0}, {"ego_distance_m", 500}})},
                 "ego_collisions");
  EXPECT_EQ(estimate.events, 1U);
  EXPECT_DOUBLE_EQ(*estimate.value, 2.0);
}

TEST(PooledEstimate, SaysWhenRoutesDifferMoreThanChance) {
  // 12 events on one of three routes of 1 km: expected 4 each, chi-square 64/4 + 16/4 + 16/4 = 24.
  std::vector<RunRecord> records;
  for (const auto& [route, events] : {std::pair{"a", 12.0}, {"b", 0.0}, {"c", 0.0}})
    records.push_back(runOf(route, "1", {{"cbv_collisions", events}, {"cbv_distance_m", 1000}}));
  const PooledEstimate estimate = estimateOf(records, "cbv_collisions");
  EXPECT_DOUBLE_EQ(*estimate.dispersion, 12.0);
  EXPECT_TRUE(estimate.over_dispersed);
  std::vector<RunRecord> more = records;  // routes without a CBV say nothing of it
  for (const char* route : {"d", "e", "f", "g"})
    more.push_back(runOf(route, "1", {{"cbv_collisions", 0}, {"cbv_distance_m", 0}}));
  EXPECT_DOUBLE_EQ(*estimateOf(more, "cbv_collisions").dispersion, 12.0);
  // Garwood's 6.2006 to 20.9616 over 3 km lie within the bootstrap's 0 to 12: all or nothing of the
  // events may be drawn.
  EXPECT_EQ(estimate.interval_kind, IntervalKind::kWider);
  EXPECT_DOUBLE_EQ(estimate.interval->low, 0.0);
  EXPECT_DOUBLE_EQ(estimate.interval->high, 12.0);
  EXPECT_NE(estimateNote(estimate, true).find("dispersion 12.0), interval by routes [0.000, 12"),
            std::string::npos)
      << estimateNote(estimate, true);
  EXPECT_EQ(estimateNote(estimate, false).find("interval"), std::string::npos);
}

TEST(PooledEstimate, WithoutDistancesIsPerRun) {
  const PooledEstimate estimate = estimateOf(
      {runOf("a", "1", {{"ego_collisions", 1}}), runOf("a", "2", {{"ego_collisions", 0}})},
      "ego_collisions");
  EXPECT_FALSE(estimate.per_km);
  EXPECT_DOUBLE_EQ(*estimate.value, 0.5);
  EXPECT_EQ(estimateText(estimate, 1, true), "1 / 2 runs = 0.5 [0.0, 2.8]");  // 5.572 / 2
}

TEST(PooledEstimate, OfASharePoolsSamples) {
  // 10 % of 100 decisions and 0 % of 900: 1 %, not 5 %.
  const PooledEstimate estimate =
      estimateOf({runOf("a", "1", {{"cbv_off_road_percent", 10}, {"cbv_decisions", 100}}),
                  runOf("b", "1", {{"cbv_off_road_percent", 0}, {"cbv_decisions", 900}})},
                 "cbv_off_road_percent");
  EXPECT_DOUBLE_EQ(*estimate.value, 1.0);
  EXPECT_DOUBLE_EQ(estimate.interval->low, 0.0);
  EXPECT_DOUBLE_EQ(estimate.interval->high, 10.0);
}

TEST(PooledEstimate, OfAShareOfCbvsPoolsCbvs) {
  // 1 of 2 CBVs passed and 6 of 6: 7 of 8 = 87.5 %, not (50 + 100) / 2 = 75 %.
  std::vector<RunRecord> records = {
      runOf("a", "1", {{"cbv_passed_percent", 50}, {"cbv_selections", 2}}),
      runOf("b", "1", {{"cbv_passed_percent", 100}, {"cbv_selections", 6}})};
  EXPECT_DOUBLE_EQ(*estimateOf(records, "cbv_passed_percent").value, 87.5);
  // A record of an earlier version counts its CBVs: (50 x 3 + 100 x 6) / 9.
  records[0].measures = {{"cbv_passed_percent", 50}, {"cbv_count", 3}};
  EXPECT_DOUBLE_EQ(*estimateOf(records, "cbv_passed_percent").value, 250.0 / 3.0);
  // Nobody was selected: nothing to weigh.
  records = {runOf("a", "1", {{"cbv_passed_percent", 50}, {"cbv_selections", 0}})};
  EXPECT_FALSE(estimateOf(records, "cbv_passed_percent").value.has_value());
  for (const char* name :
       {"cbv_completion_percent", "cbv_interactions_percent", "cbv_close_interactions_percent"})
    EXPECT_EQ(poolingOfMeasure(name).weight, metrics::SessionWeight::kCbvSelections) << name;
}

TEST(PooledEstimate, OfASharePartingTheTimesToCollisionWeighsTheTimeThatHasOne) {
  std::vector<RunRecord> records = {
      runOf("a", "1", {{"ttc_following_percent", 100}, {"ttc_defined_percent", 10}}),
      runOf("b", "1", {{"ttc_following_percent", 20}, {"ttc_defined_percent", 30}})};
  for (RunRecord& record : records) record.simulated_seconds = 60.0;
  EXPECT_DOUBLE_EQ(*estimateOf(records, "ttc_following_percent").value, 40.0);
  records[0].measures.erase("ttc_defined_percent");
  EXPECT_DOUBLE_EQ(*estimateOf(records, "ttc_following_percent").value, 20.0);
}

TEST(PooledEstimate, OfAShareAtItsBoundIsNoPoint) {
  // 4 routes at 0 %: at most 1 - 0.025^(1/4) = 60.2 % of routes may differ, by up to 100 %.
  std::vector<RunRecord> records;
  for (const char* route : {"a", "b", "c", "d"})
    records.push_back(runOf(route, "1", {{"cbv_off_road_percent", 0}, {"cbv_decisions", 100}}));
  const PooledEstimate estimate = estimateOf(records, "cbv_off_road_percent");
  EXPECT_EQ(estimate.interval_kind, IntervalKind::kUnseen);
  EXPECT_DOUBLE_EQ(estimate.interval->low, 0.0);
  EXPECT_NEAR(estimate.interval->high, 100.0 * (1.0 - std::pow(0.025, 0.25)), 1e-9);
}

TEST(PooledEstimate, OfAScoreAtItsTopIsNoPoint) {
  const PooledEstimate estimate = estimateOf({runOf("a", "1", {{"ego_driving_score", 100}}),
                                              runOf("b", "1", {{"ego_driving_score", 100}})},
                                             "ego_driving_score");
  EXPECT_NEAR(estimate.interval->low, 100.0 * std::sqrt(0.025), 1e-9);
  EXPECT_DOUBLE_EQ(estimate.interval->high, 100.0);
}

TEST(PooledEstimate, OfAnUnboundedFigureOnOneRouteHasNoInterval) {
  const PooledEstimate estimate = estimateOf(
      {runOf("a", "1", {{"ttc_mean_s", 2}}), runOf("a", "2", {{"ttc_mean_s", 4}})}, "ttc_mean_s");
  EXPECT_DOUBLE_EQ(*estimate.value, 3.0);
  EXPECT_FALSE(estimate.interval.has_value());
  EXPECT_EQ(estimate.routes, 1U);
  EXPECT_EQ(estimate.seeds, 2U);
  EXPECT_EQ(estimateNote(estimate, true), "no interval: one route has it");
  EXPECT_EQ(estimateNote(estimate, false), "");
}

TEST(Pooling, FollowsFromUnitAndSubjectUnlessSaid) {
  using metrics::Pooling;
  using metrics::SessionWeight;
  const auto rule = [](const char* name) {
    return metrics::poolingOf(*metrics::findMeasure(name));
  };
  EXPECT_EQ(rule("cbv_collisions").kind, Pooling::kCount);
  EXPECT_EQ(rule("cbv_collisions").weight, SessionWeight::kCbvKilometres);
  EXPECT_EQ(rule("ego_collisions").weight, SessionWeight::kEgoKilometres);
  EXPECT_EQ(rule("cbv_off_road_percent").kind, Pooling::kShare);
  EXPECT_EQ(rule("cbv_decisions").kind, Pooling::kMean);
  EXPECT_EQ(rule("ego_driving_score").most, 100.0);
  EXPECT_EQ(rule("speed_shapiro_wilk").kind, Pooling::kStatistic);
  EXPECT_EQ(rule("speed_shapiro_wilk").most, 1.0);
}

TEST(Pooling, EveryMeasureLiesWithinItsBounds) {
  for (const metrics::MeasureDefinition& definition : metrics::measureDefinitions()) {
    const metrics::PoolingRule rule = metrics::poolingOf(definition);
    EXPECT_NE(rule.kind, metrics::Pooling::kByUnit) << definition.name;
    EXPECT_NE(rule.weight, metrics::SessionWeight::kByKind) << definition.name;
    EXPECT_LT(rule.least, rule.most) << definition.name;
  }
}

TEST(FewWarning, NamesSeedsAndRoutes) {
  EXPECT_EQ(fewWarning(5, 10, true), "");
  EXPECT_NE(fewWarning(3, 10, true).find("only 3 seeds"), std::string::npos);
  EXPECT_NE(
      fewWarning(5, 4, true).find("Only 4 routes: too few for bootstrap intervals, which need 5."),
      std::string::npos);
  EXPECT_NE(fewWarning(5, 5, true).find("Only 5 routes: intervals by the bootstrap"),
            std::string::npos);
}

}  // namespace
}  // namespace cdiff::evaluation
