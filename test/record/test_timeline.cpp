// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "planning/perception_sample.h"
#include "record/logs/driving_log.h"
#include "record/sample_session.h"

namespace cdiff::record {
namespace {

TEST(Timeline, KeepsAFrameEveryFifthOfASecondAndTheLastTick) {
  Timeline timeline(0.05);
  for (std::uint64_t tick = 0; tick <= 9; ++tick) {
    traffic::TrafficSnapshot snapshot = test::sampleSnapshot(tick);
    if (tick == 9) snapshot.status = traffic::SessionStatus::kCompleted;
    timeline.observe(snapshot);
  }
  ASSERT_EQ(timeline.frames().size(), 4u);  // ticks 0, 4, 8 and 9
  EXPECT_DOUBLE_EQ(timeline.frames()[1].time, 0.2);
  EXPECT_DOUBLE_EQ(timeline.frames()[3].time, 0.45);
  EXPECT_DOUBLE_EQ(timeline.frames()[1].poses[0].x, 5.0 + 8.0 * 0.2);
  EXPECT_DOUBLE_EQ(timeline.duration(), 0.45);
  ASSERT_EQ(timeline.vehicles().size(), 3u);
  EXPECT_EQ(timeline.vehicles()[2].id, "bg_2");
}

TEST(Timeline, KeepsAFrameOfEachContactAndEvent) {
  Timeline timeline(0.05);
  for (std::uint64_t tick = 0; tick <= 8; ++tick) {
    traffic::TrafficSnapshot snapshot = test::sampleSnapshot(tick);
    if (tick == 5) snapshot.contacts = {{"ego", "bg_1"}};
    timeline.observe(snapshot);
  }
  timeline.addEvent(loneFrame(test::sampleSnapshot(2)));
  timeline.addEvent(loneFrame(test::sampleSnapshot(4)));  // has a frame already
  ASSERT_EQ(timeline.frames().size(), 5u);
  const std::uint64_t ticks[] = {0, 2, 4, 5, 8};
  const bool events[] = {false, true, true, true, false};
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_DOUBLE_EQ(timeline.frames()[i].time, test::sampleSnapshot(ticks[i]).time);
    EXPECT_EQ(timeline.frames()[i].event, events[i]) << i;
  }
}

TEST(Timeline, FindsTheLastContactOfAVehicle) {
  Timeline timeline(0.05);
  traffic::TrafficSnapshot snapshot;
  for (const auto& contact :
       {traffic::Contact{"a", "b"}, traffic::Contact{"b", "c"}, traffic::Contact{"a", "ego"}}) {
    ++snapshot.tick;
    snapshot.time = 0.05 * static_cast<double>(snapshot.tick);
    snapshot.contacts = {contact};
    timeline.observe(snapshot);
  }
  EXPECT_EQ(timeline.lastContactOf("a", 0.0, 1.0), "ego");
  EXPECT_EQ(timeline.lastContactOf("a", 0.0, 0.1), "b");
  EXPECT_EQ(timeline.lastContactOf("c", 0.1, 0.1), "b");
  EXPECT_EQ(timeline.lastContactOf("c", 0.15, 1.0), std::nullopt);
}

TEST(Timeline, FindsTheSmallestGapBetweenFrames) {
  Timeline timeline(0.05);
  traffic::TrafficSnapshot snapshot;
  snapshot.vehicles = {test::sampleVehicle("ego", traffic::VehicleRole::kEgo, {0.0, 0.0}, 0.0, 8.0),
                       test::sampleVehicle("a", traffic::VehicleRole::kCbv, {20.0, 0.0}, 0.0, 6.0)};
  // Boxes of 4.5 m in line: the gap is the distance of the centers less 4.5 m.
  const double distances[] = {20.0, 15.0, 10.0, 12.0};
  for (std::uint64_t tick = 0; tick < 4; ++tick) {
    snapshot.tick = tick;
    snapshot.time = 0.05 * static_cast<double>(tick);
    snapshot.vehicles[1].state.position.x() = distances[tick];
    timeline.observe(snapshot);
  }
  ASSERT_TRUE(timeline.smallestGap().has_value());
  EXPECT_DOUBLE_EQ(timeline.smallestGap()->distance, 5.5);
  EXPECT_DOUBLE_EQ(timeline.smallestGap()->time, 0.1);
  EXPECT_FLOAT_EQ(timeline.frames()[0].poses[1].gap, 15.5F);
}

TEST(Timeline, HasNoGapToAVehicleOnABridge) {
  Timeline timeline(0.05);
  traffic::TrafficSnapshot snapshot = test::sampleSnapshot(60);
  snapshot.vehicles[1].state.elevation = 8.0;
  timeline.observe(snapshot);
  EXPECT_FALSE(timeline.smallestGap().has_value());
  ASSERT_EQ(timeline.frames().size(), 1u);
  EXPECT_LT(timeline.frames()[0].poses[1].gap, 0.0F);
}

TEST(Timeline, PutsAContactMidway) {
  Timeline timeline(0.05);
  traffic::TrafficSnapshot snapshot;
  snapshot.time = 1.5;
  snapshot.vehicles = {
      test::sampleVehicle("a", traffic::VehicleRole::kBackground, {2.0, 4.0}, 0.0, 0.0),
      test::sampleVehicle("b", traffic::VehicleRole::kBackground, {4.0, 6.0}, 0.0, 0.0)};
  snapshot.contacts = {{"a", "b"}, {"a", "gone"}};
  timeline.observe(snapshot);
  ASSERT_EQ(timeline.contacts().size(), 2u);
  EXPECT_EQ(*timeline.contacts()[0].position, Eigen::Vector2d(3.0, 5.0));
  EXPECT_DOUBLE_EQ(timeline.contacts()[0].time, 1.5);
  EXPECT_FALSE(timeline.contacts()[1].position.has_value());
}

TEST(Timeline, KnowsTheTimeToCollision) {
  Timeline timeline(0.05);
  traffic::TrafficSnapshot snapshot;
  snapshot.vehicles = {
      test::sampleVehicle("ego", traffic::VehicleRole::kEgo, {0.0, 0.0}, 0.0, 8.0),
      test::sampleVehicle("a", traffic::VehicleRole::kCbv, {24.5, 0.0}, 0.0, 3.0),
      test::sampleVehicle("b", traffic::VehicleRole::kCbv, {-24.5, 0.0}, 0.0, 3.0),
      test::sampleVehicle("c", traffic::VehicleRole::kBackground, {12.5, 0.0}, 0.0, 0.0)};
  timeline.observe(snapshot);
  const auto& poses = timeline.frames()[0].poses;
  // Gaps of 8 m at 8 m/s to c, of 20 m at 5 m/s to a; b falls behind.
  EXPECT_NEAR(poses[0].time_to_collision, 1.0, 1e-6);
  EXPECT_NEAR(poses[1].time_to_collision, 4.0, 1e-6);
  EXPECT_LT(poses[2].time_to_collision, 0.0);
  EXPECT_LT(poses[3].time_to_collision, 0.0);
  EXPECT_EQ(poses[0].slot, -1);
  EXPECT_EQ(poses[1].slot, 0);
}

TEST(Timeline, KeepsWhatTheEgoPlannerBelievesToSee) {
  Timeline timeline(0.05);
  planning::PlannedAction ego{traffic::kEgoSlot, "ego", {}, {}};
  ego.perception = test::samplePerception();
  planning::PlannedAction cbv{0, "bg_1", {}, {}};
  cbv.perception = test::samplePerception();
  cbv.perception.vehicles.clear();
  for (std::uint64_t tick = 0; tick <= 4; tick += 2) {
    timeline.observe(test::sampleSnapshot(tick));
    timeline.observePerception(test::sampleSnapshot(tick), {ego, cbv});
  }
  ASSERT_EQ(timeline.frames().size(), 2u);  // ticks 0 and 4; tick 2 has no frame
  ASSERT_EQ(timeline.frames()[1].perception.vehicles.size(), 1u);
  const auto& forecasts = timeline.frames()[1].perception.vehicles[0].forecasts;
  ASSERT_EQ(forecasts.size(), 1u) << "the likeliest alone";
  EXPECT_EQ(forecasts[0].probability, 0.6);
  EXPECT_EQ(timeline.frames()[1].perception.lines.size(), 1u);
}

}  // namespace
}  // namespace cdiff::record
