// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>

#include "e2e_cdiff/core/exceptions.h"
#include "session/closed_loop.h"
#include "session/session_request.h"

namespace cdiff::session {
namespace {

constexpr double kFixed = 8.0;

CbvSpeedOptions normal() {
  CbvSpeedOptions options;
  options.distribution = "normal";
  return options;
}

TEST(CbvTargetSpeed, IsTheScenariosUnlessDrawn) {
  EXPECT_EQ(cbvTargetSpeed(CbvSpeedOptions(), kFixed, 1, "bg_1"), kFixed);
  EXPECT_EQ(ScenarioOptions().cbv_target_speed.distribution, "fixed");
}

TEST(CbvTargetSpeed, IsAMatterOfSeedAndVehicleAlone) {
  const double speed = cbvTargetSpeed(normal(), kFixed, 1, "bg_1");
  EXPECT_EQ(cbvTargetSpeed(normal(), 5.0, 1, "bg_1"), speed);
  EXPECT_NE(cbvTargetSpeed(normal(), kFixed, 2, "bg_1"), speed);
  EXPECT_NE(cbvTargetSpeed(normal(), kFixed, 1, "bg_2"), speed);
}

// N(7, 1.8^2) cut at -1.944 and +1.944 deviations: symmetric, so the mean stays 7; the variance of
// a standard normal cut at a is 1 - 2 a phi(a) / (2 Phi(a) - 1) = 1 - 2 x 1.944 x 0.0603 / 0.9481
// = 0.7527, the deviation 1.8 x 0.8676 = 1.5617. Of 4,000 draws the mean has a standard error of
// 0.0247, the deviation one below 0.0175: four of each.
TEST(CbvTargetSpeed, FollowsTheCutNormalDistribution) {
  constexpr int kDraws = 4000;
  double sum = 0.0;
  double square = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double speed = cbvTargetSpeed(normal(), kFixed, 1, "bg_" + std::to_string(i));
    ASSERT_GE(speed, 3.5);
    ASSERT_LE(speed, 10.5);
    sum += speed;
    square += speed * speed;
  }
  const double mean = sum / kDraws;
  EXPECT_NEAR(mean, 7.0, 0.1);
  EXPECT_NEAR(std::sqrt(square / kDraws - mean * mean), 1.5617, 0.07);
}

TEST(CbvTargetSpeed, ARangeThatHardlyAnyDrawMeetsIsRefused) {
  CbvSpeedOptions options = normal();
  EXPECT_NO_THROW(options.validate());
  options.mean = 11.0;
  EXPECT_THROW(options.validate(), core::InputError);
  options = normal();
  options.lowest = 6.0;
  options.highest = 7.5;
  EXPECT_THROW(options.validate(), core::InputError);
  options.deviation = 1.5;
  EXPECT_NO_THROW(options.validate());
}

SessionSetup setupWith(const std::vector<std::string>& set) {
  SessionRequest request;
  request.scenario = "roundabout_cross";
  request.set = set;
  return SessionSetup(resolveRequest(request));
}

/// Two vehicles in slots.
struct Slots {
  Slots() {
    for (int slot = 0; slot < 2; ++slot) {
      traffic::Vehicle vehicle;
      vehicle.id = "bg_" + std::to_string(slot);
      vehicle.role = traffic::VehicleRole::kCbv;
      vehicle.cbv_slot = slot;
      snapshot.vehicles.push_back(vehicle);
      cbv::CbvAssignment assignment;
      assignment.slot = slot;
      assignment.vehicle_id = vehicle.id;
      selection.assignments.push_back(assignment);
    }
  }
  traffic::TrafficSnapshot snapshot;
  cbv::CbvSelection selection;
};

// Planner and metrics aim at the same speed.
TEST(CbvTargetSpeed, TasksAndMetricsHaveIt) {
  const Slots slots;
  const SessionSetup drawn = setupWith({"cbv_target_speed.distribution=normal"});
  const auto tasks = cbvTasks(slots.snapshot, slots.selection, drawn);
  ASSERT_EQ(tasks.size(), 2U);
  EXPECT_NE(tasks[0].target_speed, tasks[1].target_speed);
  const metrics::SessionMetricsOptions options = drawn.metricsOptions();
  for (const planning::PlanningTask& task : tasks) {
    EXPECT_EQ(task.target_speed, drawn.cbvTargetSpeed(task.vehicle->id));
    EXPECT_EQ(task.target_speed, options.cbv_target_speed(task.vehicle->id));
  }
  const SessionSetup fixed = setupWith({});
  for (const auto& task : cbvTasks(slots.snapshot, slots.selection, fixed))
    EXPECT_EQ(task.target_speed, fixed.options().target_speed);
}

TEST(CbvTargetSpeed, ABadRangeIsAnErrorOfTheScenario) {
  EXPECT_THROW(setupWith({"cbv_target_speed.mean=11"}), core::InputError);
  EXPECT_THROW(setupWith({"cbv_target_speed.distribution=uniform"}), core::InputError);
}

}  // namespace
}  // namespace cdiff::session
