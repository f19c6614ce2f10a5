// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>

#include "node_graph/messages/slot_figures.h"

namespace cdiff::node_graph {
namespace {

traffic::Vehicle vehicle(const std::string& id, double x, double speed) {
  traffic::Vehicle made;
  made.id = id;
  made.role = id == traffic::kEgoId ? traffic::VehicleRole::kEgo : traffic::VehicleRole::kCbv;
  made.state.position = {x, 0.0};
  made.state.speed = speed;
  made.dimensions.length = 4.0;
  return made;
}

cbv::CbvSelection selectionOf(const std::string& id, int slot) {
  cbv::CbvAssignment assignment;
  assignment.slot = slot;
  assignment.vehicle_id = id;
  assignment.interaction_score = 0.75;
  cbv::CbvSelection selection;
  selection.assignments = {assignment};
  return selection;
}

// 20 m between centers are 16 m between boxes, closed with 8 m/s in 2 s.
TEST(SlotFigures, AreTheEgosTimeAndDistanceToTheCbvOfTheSlot) {
  traffic::TrafficSnapshot snapshot;
  snapshot.vehicles = {vehicle("ego", 0.0, 10.0), vehicle("bg_1", 20.0, 2.0)};
  const auto figures = slotFigures(snapshot, selectionOf("bg_1", 1));
  ASSERT_EQ(figures.size(), 3U);
  EXPECT_EQ(figures[0].topic.name(), "cbv_1/ttc");
  EXPECT_NEAR(figures[0].value, 2.0, 1e-9);
  EXPECT_EQ(figures[1].topic.name(), "cbv_1/gap");
  EXPECT_NEAR(figures[1].value, 16.0, 1e-9);
  EXPECT_EQ(figures[2].topic.name(), "cbv_1/score");
  EXPECT_EQ(figures[2].value, 0.75);
}

TEST(SlotFigures, ATimeThatNeverComesIsNotANumber) {
  traffic::TrafficSnapshot snapshot;
  snapshot.vehicles = {vehicle("ego", 0.0, 2.0), vehicle("bg_1", 20.0, 10.0)};
  EXPECT_TRUE(std::isnan(slotFigures(snapshot, selectionOf("bg_1", 0)).at(0).value));
}

TEST(SlotFigures, ThereAreNoneWithoutEgoOrCbv) {
  traffic::TrafficSnapshot snapshot;
  snapshot.vehicles = {vehicle("bg_1", 20.0, 2.0)};
  EXPECT_TRUE(slotFigures(snapshot, selectionOf("bg_1", 0)).empty());
  snapshot.vehicles = {vehicle("ego", 0.0, 10.0)};
  EXPECT_TRUE(slotFigures(snapshot, selectionOf("bg_1", 0)).empty());
}

}  // namespace
}  // namespace cdiff::node_graph
