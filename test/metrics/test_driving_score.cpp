// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "metrics/formulas/driving_score.h"

namespace cdiff::metrics {
namespace {

constexpr ScoreRules kRift{false, false};
constexpr ScoreRules kVersion20{false, true};
constexpr ScoreRules kVersion21{true, true};

TEST(DrivingScore, MultipliesFactorsPerEvent) {
  Infractions infractions;
  EXPECT_DOUBLE_EQ(drivingScore(83.0, infractions, kRift), 83.0);
  infractions.vehicle_collisions = 1;
  EXPECT_NEAR(drivingScore(100.0, infractions, kRift), 60.0, 1e-9);
  infractions.vehicle_collisions = 2;  // 0.6^2
  EXPECT_NEAR(drivingScore(100.0, infractions, kRift), 36.0, 1e-9);
}

TEST(DrivingScore, CombinesKinds) {
  Infractions infractions;
  infractions.pedestrian_collisions = 1;
  infractions.red_lights = 1;  // 80 x 0.5 x 0.7
  EXPECT_NEAR(drivingScore(80.0, infractions, kVersion20), 28.0, 1e-9);
  Infractions others;  // 0.65 x 0.8 x 0.7 x 0.7
  others.static_collisions = others.stop_signs = others.scenario_timeouts = others.yields_failed =
      1;
  EXPECT_NEAR(infractionPenalty(others, kVersion20), 0.2548, 1e-12);
}

TEST(DrivingScore, TakesTheShareOutsideTheLanes) {
  Infractions infractions;
  infractions.outside_lanes_percent = 10.0;
  EXPECT_NEAR(drivingScore(100.0, infractions, kRift), 90.0, 1e-9);
  infractions.outside_lanes_percent = 120.0;
  EXPECT_EQ(drivingScore(100.0, infractions, kRift), 0.0);
}

TEST(DrivingScore, CountsMinimumSpeedOnlyWhereTheRulesDo) {
  Infractions infractions;
  infractions.minimum_speed_percent = {50.0, 100.0, 100.0, 80.0};  // 0.85 x 0.94
  EXPECT_NEAR(drivingScore(100.0, infractions, kVersion20), 79.9, 1e-9);
  EXPECT_NEAR(drivingScore(100.0, infractions, kRift), 100.0, 1e-9);
  // Charges 0.4 x 0.5 + 0.4 x 0.2 = 0.28.
  EXPECT_NEAR(infractionPenalty(infractions, kVersion21), 1.0 / 1.28, 1e-12);
  infractions.minimum_speed_percent = {130.0};  // faster than the traffic is no merit
  EXPECT_EQ(infractionPenalty(infractions, kVersion20), 1.0);
}

TEST(DrivingScore, AddsChargesInVersion21) {
  Infractions infractions;
  infractions.vehicle_collisions = 1;
  infractions.red_lights = 1;  // 1 / (1 + 0.7 + 0.4)
  EXPECT_NEAR(drivingScore(100.0, infractions, kVersion21), 47.62, 5e-3);
}

}  // namespace
}  // namespace cdiff::metrics
