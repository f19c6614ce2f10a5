// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "node_graph/messages/display.h"
#include "node_graph/messages/ego_sensors.h"
#include "record/sample_session.h"
#include "sensor_msgs/point_cloud2_iterator.h"
#include "support/snapshot_builder.h"

namespace cdiff::node_graph {
namespace {

TEST(TrackedObjects, HoldWhatIsNearNearestFirst) {
  traffic::TrafficSnapshot snapshot = test::snapshotWithEgo(4, {10.0, 0.0});
  snapshot.vehicles.push_back(test::vehicle("far", {130.0, 0.0}));
  snapshot.vehicles.push_back(test::vehicle("b", {40.0, 0.0, 90.0, 5.0}));
  snapshot.vehicles.push_back(test::vehicle("a", {-20.0, 0.0}));
  snapshot.vehicles.push_back(test::vehicle("near", {10.0, 6.0}));
  const ::e2e_cdiff::TrackedObjects objects = toObjectsMsg(snapshot, 100.0);
  EXPECT_EQ(objects.tick, 4U);
  ASSERT_EQ(objects.objects.size(), 3U);
  EXPECT_EQ(objects.objects[0].id, "near");
  EXPECT_EQ(objects.objects[1].id, "a") << "as near as b";
  EXPECT_EQ(objects.objects[2].id, "b");
  EXPECT_EQ(objects.objects[2].distance, 30.0);
  EXPECT_NEAR(objects.objects[2].velocity_x, 0.0, 1e-12);
  EXPECT_NEAR(objects.objects[2].velocity_y, 5.0, 1e-12);
  const visualization_msgs::MarkerArray markers = toObjectMarkers(objects);
  ASSERT_EQ(markers.markers.size(), 3U);
  EXPECT_EQ(markers.markers[2].text, "b");
  EXPECT_EQ(markers.markers[2].scale.x, 4.5);
  EXPECT_EQ(markers.markers[2].header.frame_id, "map");
}

TEST(TrackedObjects, AreNoneWithoutAnEgo) {
  traffic::TrafficSnapshot snapshot;
  snapshot.vehicles.push_back(test::vehicle("b", {40.0, 0.0}));
  EXPECT_TRUE(toObjectsMsg(snapshot, 100.0).objects.empty());
}

TEST(Odometry, SaysHowSureItIs) {
  const traffic::Vehicle ego =
      test::vehicle("ego", {1.0, 2.0, 90.0, 3.0}, traffic::VehicleRole::kEgo);
  const nav_msgs::Odometry odometry = toOdometryMsg(ego, 1.5);
  for (std::size_t row = 0; row < 6; ++row) {
    for (std::size_t column = 0; column < 6; ++column) {
      const double expected = row == column ? 1e-6 : 0.0;
      EXPECT_EQ(odometry.pose.covariance[6 * row + column], expected);
      EXPECT_EQ(odometry.twist.covariance[6 * row + column], expected);
    }
  }
}

TEST(Scans, BecomeMessagesInTheirFrames) {
  const test::SampleSetup sample;
  const traffic::TrafficSnapshot snapshot = test::sampleSnapshot(100);
  const session::EgoOptions options;
  rendering::RangeSensor laser(options.laser, sample.setup.network());
  const sensor_msgs::LaserScan scan =
      toLaserScanMsg(laser, laser.scan(snapshot, "ego"), snapshot.time, "ego");
  EXPECT_EQ(scan.header.frame_id, "ego/laser");
  ASSERT_EQ(scan.ranges.size(), 720U);
  EXPECT_NEAR(scan.angle_min + 719 * scan.angle_increment, scan.angle_max, 1e-4);
  rendering::RangeSensor lidar(options.lidar, sample.setup.network());
  const rendering::RangeScan measured = lidar.scan(snapshot, "ego");
  const sensor_msgs::PointCloud2 cloud = toPointCloudMsg(lidar, measured, snapshot.time, "ego");
  EXPECT_EQ(cloud.header.frame_id, "ego/base_link");
  const std::vector<Eigen::Vector3f> points = lidar.points(measured);
  ASSERT_EQ(cloud.width * cloud.height, points.size());
  ASSERT_FALSE(points.empty());
  sensor_msgs::PointCloud2ConstIterator<float> place(cloud, "x");
  for (const Eigen::Vector3f& point : points) {
    EXPECT_EQ(Eigen::Vector3f(place[0], place[1], place[2]), point);
    ++place;
  }
}

}  // namespace
}  // namespace cdiff::node_graph
