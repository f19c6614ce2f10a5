// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <fstream>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "record/logs/plan_log.h"
#include "record/sample_session.h"
#include "support/temporary_folder.h"

namespace cdiff::record {
namespace {

/// A CBV at x = 10 t that plans x + 8 h, seen from tick 0 to `last`; one decision at tick 0.
PlanLog logUntil(std::uint64_t last, const std::string& id = "a") {
  PlanLog log(0.05);
  for (std::uint64_t tick = 0; tick <= last; ++tick) {
    traffic::TrafficSnapshot snapshot;
    snapshot.tick = tick;
    snapshot.time = 0.05 * static_cast<double>(tick);
    snapshot.vehicles = {test::sampleVehicle(id, traffic::VehicleRole::kCbv,
                                             {10.0 * snapshot.time, 0.0}, 0.0, 10.0)};
    std::vector<planning::PlannedAction> actions(1);
    actions[0].slot = 0;
    actions[0].vehicle_id = id;
    for (int i = 1; i <= 10; ++i) {
      planning::RolloutPoint point;
      point.state.position = {0.8 * i, 0.0};
      point.state.speed = 8.0;
      actions[0].rollout.push_back(point);
    }
    session::TickRecord record;
    record.snapshot = &snapshot;
    if (tick == 0) record.actions = &actions;
    log.observe(record);
  }
  return log;
}

std::vector<PlanRow> written(const PlanLog& log) {
  const test::TemporaryFolder scratch;
  core::writeFileAtomically(scratch.path() / "plans.csv", plansCsv(log));
  return readPlans(scratch.path() / "plans.csv");
}

TEST(PlanFile, HoldsPlannedAndDrivenStatesEvery04Seconds) {
  const std::vector<PlanRow> rows = written(logUntil(12));  // 0.6 s
  // 10 points: 0, 0.4 and 0.8 s; the last was not driven any more.
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_DOUBLE_EQ(rows[1].seconds, 0.4);
  EXPECT_NEAR(rows[1].planned.position.x(), 3.2, 1e-12);
  ASSERT_TRUE(rows[1].driven);
  EXPECT_NEAR(rows[1].driven->position.x(), 4.0, 1e-12);
  EXPECT_DOUBLE_EQ(rows[1].planned.speed, 8.0);
  EXPECT_DOUBLE_EQ(rows[1].driven->speed, 10.0);
  EXPECT_DOUBLE_EQ(rows[2].seconds, 0.8);
  EXPECT_FALSE(rows[2].driven);
  EXPECT_EQ(rows[0].planned.position, rows[0].driven->position);
}

TEST(PlanFile, ReadsBackIdsWithLineEnds) {
  const std::vector<PlanRow> rows = written(logUntil(12, "a\n\"b\""));
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[2].vehicle_id, "a\n\"b\"");
}

TEST(PlanFile, IsAHeaderAloneWithoutPlans) { EXPECT_TRUE(written(PlanLog(0.05)).empty()); }

TEST(PlanFile, NamesTheLineThatIsDamaged) {
  const test::TemporaryFolder scratch;
  const auto file = scratch.path() / "plans.csv";
  const std::string row = "a,0,0,1,2,3,4";
  for (const std::string& damaged :
       {std::string("a,0,x\n"), row + ",1,2,3,x\n", row + ",1,2,3,4"}) {
    std::ofstream(file) << plansCsv(logUntil(12)) << damaged;
    try {
      readPlans(file);
      FAIL() << "no error: " << damaged;
    } catch (const core::InputError& error) {
      EXPECT_NE(std::string(error.what()).find("plans.csv:5"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace cdiff::record
