// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <limits>

#include "record/logs/planner_logs.h"

namespace cdiff::record {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

void decide(GuidanceLog& log, double time, int slot,
            const std::vector<guidance::ObjectiveReport>& objectives, double trust = 0.0) {
  traffic::TrafficSnapshot snapshot;
  snapshot.time = time;
  std::vector<planning::PlannedAction> actions(1);
  actions[0].slot = slot;
  actions[0].vehicle_id = "v" + std::to_string(slot);
  actions[0].guidance.objectives = objectives;
  actions[0].guidance.trust_region_share = trust;
  session::TickRecord record;
  record.snapshot = &snapshot;
  record.actions = &actions;
  log.observe(record);
}

TEST(GuidanceLog, AveragesEachObjectiveOverItsDecisions) {
  GuidanceLog log;
  decide(log, 0.0, 0, {{"speed", 2.0, 4.0, 1.0, 0.0, 1}, {"comfort", 1.0, 7.0, 0.0, 0.0, 0}}, 0.25);
  decide(log, 0.1, 1, {{"speed", 2.0, 6.0, 2.0, 0.5, 2}}, 0.75);
  ASSERT_EQ(log.series().size(), 2u);
  EXPECT_EQ(log.series()[0].objective, "speed");
  EXPECT_EQ(log.series()[0].samples[1].vehicle_id, "v1");
  EXPECT_EQ(log.series()[0].samples[1].time, 0.1);
  const ObjectiveSummary speed = summaryOf(log.series()[0]);
  EXPECT_EQ(speed.n, 2u);
  EXPECT_DOUBLE_EQ(*speed.weight, 2.0);
  EXPECT_DOUBLE_EQ(*speed.value, 5.0);
  EXPECT_DOUBLE_EQ(*speed.gradient_norm, 1.5);
  EXPECT_DOUBLE_EQ(*speed.capped_share, 0.25);
  EXPECT_EQ(speed.dropped, 3);
  EXPECT_EQ(summaryOf(log.series()[1]).n, 1u);
  EXPECT_DOUBLE_EQ(*log.trustRegion().mean, 0.5);
}

TEST(GuidanceLog, WhatIsNotFiniteIsLeftOutOfTheMean) {
  GuidanceLog log;
  decide(log, 0.0, 0, {{"speed", 1.0, kNan, kNan, 0.0, 0}});
  EXPECT_FALSE(summaryOf(log.series()[0]).value.has_value());
  decide(log, 0.1, 0, {{"speed", 1.0, 3.0, kNan, 0.0, 0}});
  EXPECT_DOUBLE_EQ(*summaryOf(log.series()[0]).value, 3.0);
  EXPECT_FALSE(summaryOf(log.series()[0]).gradient_norm.has_value());
  EXPECT_EQ(summaryOf(log.series()[0]).n, 2u);
}

TEST(GuidanceLog, CountsAttacksWithdrawalsAndRefusals) {
  GuidanceLog log;
  EXPECT_EQ(log.challenge().decisions, 0u);
  const auto decideState = [&](const std::string& state, const std::string& reason,
                               const std::vector<std::string>& refusals) {
    traffic::TrafficSnapshot snapshot;
    std::vector<planning::PlannedAction> actions(1);
    actions[0].slot = 0;
    actions[0].vehicle_id = "v0";
    actions[0].guidance.objectives = {{"speed", 1.0, 1.0, 0.0, 0.0, 0}};
    actions[0].guidance.challenge.state = state;
    actions[0].guidance.challenge.reason = reason;
    actions[0].guidance.challenge.refusals = refusals;
    session::TickRecord record;
    record.snapshot = &snapshot;
    record.actions = &actions;
    log.observe(record);
  };
  decideState("drives", "", {"from behind", ""});
  decideState("attacks", "", {"", ""});
  decideState("attacks", "", {"", "from behind"});
  decideState("withdrawn", "the ego stands", {"the ego stands", "the ego stands"});
  decideState("attacks", "", {""});
  const ChallengeCounts& counts = log.challenge();
  EXPECT_EQ(counts.decisions, 5u);
  EXPECT_EQ(counts.attacks, 2u);
  EXPECT_EQ(counts.attacking, 3u);
  EXPECT_EQ(counts.withdrawn, (std::map<std::string, std::size_t>{{"the ego stands", 1}}));
  EXPECT_EQ(counts.refused,
            (std::map<std::string, std::size_t>{{"from behind", 2}, {"the ego stands", 2}}));
}

TEST(GuidanceLog, TheEgoAndUnguidedPlansDoNotCount) {
  GuidanceLog log;
  decide(log, 0.0, -1, {{"speed", 1.0, 1.0, 0.0, 0.0, 0}});
  decide(log, 0.0, 0, {}, 0.5);
  EXPECT_TRUE(log.series().empty());
  EXPECT_EQ(log.trustRegion().n, 0u);
}

}  // namespace
}  // namespace cdiff::record
