// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/report/cbv_log.h"

namespace cdiff::report {
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

}  // namespace
}  // namespace cdiff::report
