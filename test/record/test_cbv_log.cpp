// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "record/logs/cbv_log.h"
#include "record/sample_session.h"

namespace cdiff::record {
namespace {

cbv::CbvAssignment assignment(int slot, const std::string& id, std::uint64_t selected_tick) {
  cbv::CbvAssignment assignment;
  assignment.slot = slot;
  assignment.vehicle_id = id;
  assignment.selected_tick = selected_tick;
  return assignment;
}

cbv::CbvSelection selection(std::uint64_t tick,
                            const std::vector<cbv::CbvAssignment>& assignments) {
  cbv::CbvSelection selection;
  selection.tick = tick;
  selection.assignments = assignments;
  return selection;
}

traffic::TrafficSnapshot snapshotWith(const std::vector<std::string>& ids,
                                      traffic::VehicleRole role = traffic::VehicleRole::kCbv) {
  traffic::TrafficSnapshot snapshot;
  for (const std::string& id : ids) {
    snapshot.vehicles.emplace_back();
    snapshot.vehicles.back().id = id;
    snapshot.vehicles.back().role = role;
  }
  return snapshot;
}

TEST(CbvLog, FollowsAStayFromSelectionToRelease) {
  CbvLog log;
  cbv::CbvAssignment a = assignment(0, "a", 2);
  a.conflict_point.ego_distance = 40.0;
  log.observe(snapshotWith({"a"}, traffic::VehicleRole::kBackground), selection(2, {a}));
  a.conflict_point.ego_distance = 30.0;  // as of a later decision: not recorded
  log.observe(snapshotWith({"a"}), selection(4, {a}));
  log.observe(snapshotWith({"a"}), selection(5, {a}));
  log.observe(snapshotWith({}), selection(6, {a}));  // gone from the snapshot: not driven
  cbv::CbvSelection last = selection(8, {assignment(0, "b", 8)});
  last.released = {{0, "a", "contact"}};
  log.observe(snapshotWith({"b"}), last);

  ASSERT_EQ(log.records().size(), 2u);
  EXPECT_EQ(log.records()[0].vehicle_id, "a");
  EXPECT_EQ(log.records()[0].conflict_point.ego_distance, 40.0);
  EXPECT_EQ(log.records()[0].decisions_driven, 2u);
  EXPECT_EQ(log.records()[0].released_tick, std::uint64_t{8});
  EXPECT_EQ(log.records()[0].release_reason, "contact");
  EXPECT_EQ(log.records()[1].vehicle_id, "b");
  EXPECT_EQ(log.records()[1].decisions_driven, 1u);
  EXPECT_FALSE(log.records()[1].released_tick.has_value());
  EXPECT_EQ(log.records()[1].release_reason, "session_end");
}

TEST(CbvLog, TheSameVehicleSelectedAgainIsANewStay) {
  CbvLog log;
  log.observe(snapshotWith({"a"}), selection(2, {assignment(1, "a", 2)}));
  log.observe(snapshotWith({"a"}), selection(4, {}));
  log.observe(snapshotWith({"a"}), selection(6, {assignment(1, "a", 6)}));
  ASSERT_EQ(log.records().size(), 2u);
  EXPECT_EQ(log.records()[0].release_reason, "not_stated");
  EXPECT_EQ(log.records()[0].released_tick, std::uint64_t{4});
  EXPECT_EQ(log.records()[1].selected_tick, 6u);
}

TEST(CbvLog, CountsRejectionsByReason) {
  CbvLog log;
  cbv::CbvSelection decision = selection(0, {});
  decision.rejected = {{"a", "too_far", 0.0}, {"b", "no_way", 0.0}, {"c", "too_far", 0.0}};
  log.observe({}, decision);
  decision.rejected = {{"a", "too_far", 0.0}};
  log.observe({}, decision);
  EXPECT_EQ(log.rejected(), (std::map<std::string, std::size_t>{{"no_way", 1}, {"too_far", 3}}));
}

/// The stay of "bg_1" from tick 52, on a route of 104 m with the conflict point after 42 m, driven
/// to `arc_length`; released there for `reason` unless empty.
CbvRecord stayOf(double arc_length, const std::string& reason) {
  const test::SampleSetup sample;
  CbvLog log;
  traffic::TrafficSnapshot snapshot = test::sampleSnapshot(53);
  for (double s = 0.0; s < arc_length; s += 0.6) {
    snapshot.vehicles[1].state.position = {102.0, -44.0 + s};
    log.observe(snapshot, test::sampleSelection(52, sample.setup.network()));
  }
  snapshot.vehicles[1].state.position = {102.0, -44.0 + arc_length};
  cbv::CbvSelection last = test::sampleSelection(52, sample.setup.network());
  if (!reason.empty()) last.assignments.clear();
  last.tick = 400;
  last.released = {{0, "bg_1", reason}};
  log.observe(snapshot, last);
  return log.records().at(0);
}

TEST(CbvLog, FollowsTheVehicleAlongItsConflictAwareRoute) {
  const CbvRecord record = stayOf(26.0, "contact");
  EXPECT_NEAR(record.arc_length, 26.0, 1e-9);
  EXPECT_NEAR(record.routeCompletionPercent(), 25.0, 1e-9);  // of 104 m
  EXPECT_FALSE(record.conflict_point_passed);
  EXPECT_FALSE(record.routeCompleted());
}

TEST(CbvLog, TheConflictPointIsPassedByTheCenter) {
  EXPECT_FALSE(stayOf(41.9, "").conflict_point_passed);
  const CbvRecord record = stayOf(42.1, "");
  EXPECT_TRUE(record.conflict_point_passed);
  EXPECT_TRUE(record.routeCompleted());
  EXPECT_NEAR(record.routeCompletionPercent(), 100.0 * 42.1 / 104.0, 1e-9);
  EXPECT_EQ(record.release_reason, "session_end");
}

TEST(CbvLog, ARouteThatEndedIsCompleted) {
  const CbvRecord record =
      stayOf(10.0, "route_end");  // removed at the end before a decision saw it
  EXPECT_DOUBLE_EQ(record.routeCompletionPercent(), 100.0);
  EXPECT_TRUE(record.routeCompleted());
}

}  // namespace
}  // namespace cdiff::record
