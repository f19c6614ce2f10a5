// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <limits>

#include "record/logs/plan_log.h"
#include "record/sample_session.h"

namespace cdiff::record {
namespace {

using traffic::VehicleRole;

/// A vehicle "a" that drives x = 10 t; its plan at a decision: x from there at `planned_speed`, y =
/// `offset`.
class Drive {
 public:
  explicit Drive(double step = 0.05) : step_(step), log_(step) {}

  void tick(std::uint64_t tick, VehicleRole role = VehicleRole::kCbv) { play(tick, role, nullptr); }
  void decide(std::uint64_t tick, double planned_speed, double offset, int points,
              double mismatch = 0.0, VehicleRole role = VehicleRole::kCbv) {
    std::vector<planning::PlannedAction> actions(1);
    actions[0].slot = 0;
    actions[0].vehicle_id = "a";
    actions[0].state_mismatch = mismatch;
    const double x = 10.0 * step_ * static_cast<double>(tick);
    for (int i = 1; i <= points; ++i) {
      planning::RolloutPoint point;
      point.state.position = {x + 0.1 * i * planned_speed, offset};
      actions[0].rollout.push_back(point);
    }
    play(tick, role, &actions);
  }
  const PlanLog& log() const { return log_; }
  const VehiclePlans& a() const { return *log_.find("a"); }

 private:
  void play(std::uint64_t tick, VehicleRole role,
            const std::vector<planning::PlannedAction>* actions) {
    traffic::TrafficSnapshot snapshot;
    snapshot.tick = tick;
    snapshot.time = step_ * static_cast<double>(tick);
    snapshot.vehicles = {test::sampleVehicle("a", role, {10.0 * snapshot.time, 0.0}, 0.0, 10.0)};
    session::TickRecord record;
    record.snapshot = &snapshot;
    record.actions = actions;
    log_.observe(record);
  }
  double step_;
  PlanLog log_;
};

TEST(PlanLog, MeasuresDisplacementsBetweenPlanAndDrive) {
  Drive drive;
  // Selected at tick 0, when SUMO still drives it; 9 m/s planned, 10 m/s driven.
  drive.decide(0, 9.0, 0.0, 32, 0.25, VehicleRole::kBackground);
  drive.tick(1);
  drive.decide(2, 10.0, 0.5, 32, 0.75);  // as driven, but 0.5 m to the left
  for (std::uint64_t tick = 3; tick <= 41; ++tick) drive.tick(tick);
  // After 1 s (ticks 20 and 22): 1 m and 0.5 m; nearest rank ceil(0.95 x 2) = 2.
  const SampleSummary one = displacementSummary(drive.log(), 1.0);
  EXPECT_EQ(one.n, 2u);
  EXPECT_NEAR(*one.mean, 0.75, 1e-12);
  EXPECT_NEAR(*one.percentile_95, 1.0, 1e-12);
  // After 2 s: tick 40 was driven, tick 42 was not.
  const SampleSummary two = displacementSummary(drive.log(), 2.0);
  EXPECT_EQ(two.n, 1u);
  EXPECT_NEAR(*two.mean, 2.0, 1e-12);
  const SampleSummary three = displacementSummary(drive.log(), 3.0);
  EXPECT_EQ(three.n, 0u);
  EXPECT_FALSE(three.mean.has_value());
  const SampleSummary mismatch = mismatchSummary(drive.log());
  EXPECT_DOUBLE_EQ(*mismatch.mean, 0.5);
  EXPECT_DOUBLE_EQ(*mismatch.percentile_95, 0.75);
  EXPECT_DOUBLE_EQ(*mismatch.maximum, 0.75);
}

TEST(PlanLog, APlanThatIsShorterIsNotMeasuredBeyondItsEnd) {
  Drive drive;
  drive.decide(0, 9.0, 0.0, 15);
  for (std::uint64_t tick = 1; tick <= 80; ++tick) drive.tick(tick);
  EXPECT_EQ(drive.log().displacements(drive.a(), 1.0).size(), 1u);
  EXPECT_TRUE(drive.log().displacements(drive.a(), 2.0).empty());
}

TEST(PlanLog, ADriveThatWasInterruptedIsNotMeasured) {
  Drive drive;
  drive.decide(0, 9.0, 0.0, 32);
  for (std::uint64_t tick = 1; tick <= 30; ++tick) {
    drive.tick(tick, tick == 10 ? VehicleRole::kBackground : VehicleRole::kCbv);
  }
  EXPECT_TRUE(drive.log().displacements(drive.a(), 1.0).empty());
}

TEST(PlanLog, InterpolatesBetweenTicks) {
  Drive drive(0.04);
  drive.decide(0, 10.0, 0.0, 1);
  for (std::uint64_t tick = 1; tick <= 3; ++tick) drive.tick(tick);
  // 0.1 s are 2.5 ticks: between x = 0.8 m and 1.2 m.
  const auto state = drive.log().drivenAfter(drive.a(), drive.a().plans[0], 0.1);
  ASSERT_TRUE(state.has_value());
  EXPECT_NEAR(state->position.x(), 1.0, 1e-12);
}

TEST(PlanLog, FindsThePlanNearATimeThatWasDrivenToItsEnd) {
  Drive drive;
  for (std::uint64_t tick = 0; tick <= 30; ++tick) {
    if (tick % 10 == 0) {
      drive.decide(tick, 10.0, 0.0, 10);  // 1 s: 20 ticks
    } else {
      drive.tick(tick);
    }
  }
  // Decisions at 0, 0.5, 1 and 1.5 s; driven until 1.5 s: only the first two to their end.
  EXPECT_EQ(drive.log().drivenPlanNear(drive.a(), -3.0)->tick, 0u);
  EXPECT_EQ(drive.log().drivenPlanNear(drive.a(), 0.3)->tick, 10u);
  EXPECT_EQ(drive.log().drivenPlanNear(drive.a(), 0.25)->tick, 0u);  // the earlier of equals
  EXPECT_EQ(drive.log().drivenPlanNear(drive.a(), 1.4)->tick, 10u);
}

TEST(PlanLog, LeavesOutWhatIsNotFinite) {
  Drive drive;
  drive.decide(0, std::numeric_limits<double>::quiet_NaN(), 0.0, 32,
               std::numeric_limits<double>::infinity());
  for (std::uint64_t tick = 1; tick <= 30; ++tick) drive.tick(tick);
  EXPECT_EQ(displacementSummary(drive.log(), 1.0).n, 0u);
  EXPECT_FALSE(mismatchSummary(drive.log()).maximum.has_value());
}

TEST(PlanLog, IsEmptyWithoutRollouts) {
  Drive drive;
  drive.decide(0, 9.0, 0.0, 0);
  drive.tick(1);
  EXPECT_TRUE(drive.log().empty());
  EXPECT_EQ(drive.log().drivenPlanNear(drive.a(), 0.0), nullptr);
}

}  // namespace
}  // namespace cdiff::record
