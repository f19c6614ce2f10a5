// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "record/logs/cbv_log.h"
#include "record/sample_session.h"

namespace cdiff::record {
namespace {

using traffic::VehicleRole;

traffic::TrafficSnapshot lineUp(std::uint64_t tick, double distance) {
  traffic::TrafficSnapshot snapshot;
  snapshot.tick = tick;
  snapshot.time = 0.05 * static_cast<double>(tick);
  snapshot.vehicles = {test::sampleVehicle("ego", VehicleRole::kEgo, {0.0, 0.0}, 0.0, 8.0),
                       test::sampleVehicle("a", VehicleRole::kCbv, {distance, 0.0}, 0.0, 6.0)};
  return snapshot;
}

void show(ApproachLog& log, const traffic::TrafficSnapshot& snapshot) {
  session::TickRecord record;
  record.snapshot = &snapshot;
  log.observe(record);
}

/// A decision at which the planner of slot 0 sees an image of one pixel.
void decide(ApproachLog& log, const traffic::TrafficSnapshot& snapshot, std::uint8_t red) {
  const cbv::CbvSelection selection;
  const std::vector<session::SlotImage> images = {{0, {1, 1, snapshot.tick, {red, 0, 0}}}};
  session::TickRecord record;
  record.snapshot = &snapshot;
  record.selection = &selection;
  record.images = &images;
  log.observe(record);
}

TEST(ApproachLog, KeepsTheTickWithTheSmallestGapAndWhatWasSeenThen) {
  ApproachLog log;
  decide(log, lineUp(0, 20.0), 10);
  show(log, lineUp(1, 15.0));
  decide(log, lineUp(2, 12.0), 20);
  show(log, lineUp(3, 10.0));
  decide(log, lineUp(4, 10.0), 30);  // as near again: the first counts
  show(log, lineUp(5, 14.0));
  ASSERT_EQ(log.approaches().size(), 1u);
  const Approach& approach = log.approaches()[0];
  EXPECT_EQ(approach.snapshot.tick, 3u);
  EXPECT_NEAR(approach.gap, 5.5, 1e-12);  // boxes of 4.5 m in line
  EXPECT_DOUBLE_EQ(approach.center_distance, 10.0);
  EXPECT_EQ(approach.snapshot.find("a")->state.position.x(), 10.0);
  ASSERT_FALSE(approach.cbv_image.empty());
  EXPECT_EQ(approach.cbv_image.tick, 2u);
  EXPECT_EQ(approach.cbv_image.rgb[0], 20);
  EXPECT_TRUE(approach.ego_image.empty());
}

TEST(ApproachLog, AVehicleThatIsNotDrivenDoesNotCount) {
  ApproachLog log;
  traffic::TrafficSnapshot near = lineUp(0, 6.0);
  near.vehicles[1].role = VehicleRole::kBackground;
  show(log, near);
  EXPECT_TRUE(log.approaches().empty());
  EXPECT_EQ(log.find("a"), nullptr);
  show(log, lineUp(1, 30.0));
  EXPECT_EQ(log.find("a")->snapshot.tick, 1u);
}

TEST(ApproachLog, ABridgeIsNoApproach) {
  ApproachLog log;
  traffic::TrafficSnapshot snapshot = lineUp(0, 0.0);
  snapshot.vehicles[1].state.elevation = 8.0;
  show(log, snapshot);
  EXPECT_TRUE(log.approaches().empty());
}

TEST(ApproachLog, AnImageThatIsNotWholeIsNotKept) {
  ApproachLog log;
  const traffic::TrafficSnapshot snapshot = lineUp(0, 10.0);
  const std::vector<session::SlotImage> images = {{0, {2, 2, 0, {1, 2, 3}}}};
  session::TickRecord record;
  record.snapshot = &snapshot;
  record.images = &images;
  log.observe(record);
  EXPECT_TRUE(log.approaches()[0].cbv_image.empty());
}

TEST(ApproachLog, TheFourNearestAreShown) {
  ApproachLog log;
  const double distances[] = {30.0, 10.0, 25.0, 10.0, 20.0};
  traffic::TrafficSnapshot snapshot = lineUp(0, 0.0);
  snapshot.vehicles.pop_back();
  for (int i = 0; i < 5; ++i) {
    snapshot.vehicles.push_back(test::sampleVehicle(std::string(1, static_cast<char>('a' + i)),
                                                    VehicleRole::kCbv, {distances[i], 0.0}, 0.0,
                                                    6.0));
  }
  show(log, snapshot);
  std::string ids;
  for (const Approach* approach : log.nearest()) ids += approach->vehicle_id;
  EXPECT_EQ(ids, "bdec");  // ties in order
}

TEST(ApproachLog, OfTheOthersAFrameAloneIsKept) {
  ApproachLog log;
  for (int i = 0; i < 5; ++i) {  // the first one is the farthest
    traffic::TrafficSnapshot snapshot = lineUp(static_cast<std::uint64_t>(i), 30.0 - i);
    snapshot.vehicles[1].id = std::string(1, static_cast<char>('a' + i));
    decide(log, snapshot, 10);
  }
  const Approach& far = log.approaches()[0];
  EXPECT_FALSE(far.isWhole());
  EXPECT_TRUE(far.cbv_image.empty());
  EXPECT_DOUBLE_EQ(far.time(), 0.0);
  ASSERT_EQ(far.event().frame.poses.size(), 2u);
  EXPECT_DOUBLE_EQ(far.event().frame.poses[1].x, 30.0);
  EXPECT_EQ(far.event().vehicles[1].id, "a");
  traffic::TrafficSnapshot again = lineUp(9, 12.0);  // it comes nearest
  decide(log, again, 20);
  EXPECT_EQ(log.nearest().front()->vehicle_id, "a");
  EXPECT_EQ(log.nearest().front()->cbv_image.rgb[0], 20);
  EXPECT_FALSE(log.find("b")->isWhole());
  EXPECT_DOUBLE_EQ(log.find("b")->event().frame.poses[1].x, 29.0);
}

}  // namespace
}  // namespace cdiff::record
