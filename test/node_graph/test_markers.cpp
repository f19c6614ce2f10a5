// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <set>

#include "node_graph/messages/display.h"
#include "node_graph/messages/markers.h"
#include "node_graph/sample_messages.h"
#include "planning/perception_sample.h"

namespace cdiff::node_graph {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

int count(const MarkerArray& array, const std::string& marker_namespace) {
  int found = 0;
  for (const Marker& marker : array.markers)
    found += marker.ns == marker_namespace && marker.action == Marker::ADD;
  return found;
}

TEST(Markers, OnlyTheFirstArrayClearsAndEveryIdIsItsOwn) {
  SessionMarkers markers;
  const MarkerArray first = markers.build(test::sampleSnapshot(0), nullptr);
  const MarkerArray second = markers.build(test::sampleSnapshot(2), nullptr);
  EXPECT_EQ(first.markers.front().action, Marker::DELETEALL);
  std::set<std::pair<std::string, int>> ids;
  for (const Marker& marker : second.markers) {
    EXPECT_EQ(marker.action, Marker::ADD);
    EXPECT_EQ(marker.lifetime, ros::Duration(0.5));
    EXPECT_EQ(marker.header.frame_id, "map");
    EXPECT_TRUE(ids.emplace(marker.ns, marker.id).second) << marker.ns << marker.id;
  }
  EXPECT_EQ(count(second, "vehicles"), 3);
  EXPECT_EQ(count(second, "labels"), 2);  // ego and CBV
}

TEST(Markers, RolesHaveTheirColors) {
  SessionMarkers markers;
  const MarkerArray array = markers.build(test::sampleSnapshot(0), nullptr);
  std::vector<Marker> vehicles;
  for (const Marker& marker : array.markers) {
    if (marker.ns == "vehicles") vehicles.push_back(marker);
  }
  ASSERT_EQ(vehicles.size(), 3U);                           // ego, CBV, background
  EXPECT_GT(vehicles[0].color.r, 2 * vehicles[0].color.b);  // red
  EXPECT_GT(vehicles[1].color.b, 2 * vehicles[1].color.g);  // purple: red and blue
  EXPECT_GT(vehicles[1].color.r, 2 * vehicles[1].color.g);
  EXPECT_GT(vehicles[2].color.b, 2 * vehicles[2].color.r);  // blue
}

TEST(Markers, SelectionShowsConflictPointAndRoute) {
  const session::SessionSetup setup(session::loadScenario("crossing_left_turn"));
  cbv::CbvSelection selection;
  selection.assignments.resize(1);
  selection.assignments[0].conflict_aware_route = setup.egoRoute();
  const MarkerArray array = SessionMarkers().build(test::sampleSnapshot(0), &selection);
  EXPECT_EQ(count(array, "conflict_points"), 1);
  EXPECT_EQ(count(array, "conflict_aware_routes"), 1);
  const MarkerArray map = mapMarkers(setup);
  EXPECT_EQ(map.markers.front().action, Marker::DELETEALL);
  EXPECT_EQ(count(map, "lanes"), 1);
  EXPECT_EQ(map.markers.back().points.size(), setup.egoRoute().path().points().size());
}

TEST(Display, TransformsAreOfEgoAndCbvsOnly) {
  const tf2_msgs::TFMessage message = toTfMsg(test::sampleSnapshot(4));
  ASSERT_EQ(message.transforms.size(), 2U);
  EXPECT_EQ(message.transforms[0].child_frame_id, "ego/base_link");
  EXPECT_EQ(message.transforms[1].child_frame_id, "bg_7/base_link");
  EXPECT_EQ(message.transforms[0].header.stamp, ros::Time(0.2));
}

TEST(Display, CameraSitsOnTheMountAndLooksDownTheRoad) {
  rendering::CameraOptions camera;
  camera.mount_forward = 0.5;
  camera.mount_height = 1.4;
  camera.pitch = 30.0;
  const session::VehicleRigs rigs = session::VehicleRigs::front(camera);
  const tf2_msgs::TFMessage message = toTfMsg(test::sampleSnapshot(4), &rigs);
  ASSERT_EQ(message.transforms.size(), 6U);  // base_link of two, then camera and optical frame each
  const auto& mount = message.transforms[4];
  EXPECT_EQ(mount.header.frame_id, "bg_7/base_link");
  EXPECT_EQ(mount.child_frame_id, "bg_7/camera");
  EXPECT_EQ(mount.transform.translation.x, 0.5);
  EXPECT_EQ(mount.transform.translation.z, 1.4);
  const auto& optical = message.transforms[5];
  EXPECT_EQ(optical.header.frame_id, "bg_7/camera");
  EXPECT_EQ(optical.child_frame_id, "bg_7/camera_optical");
  const auto rotation = [](const geometry_msgs::Quaternion& q) {
    return Eigen::Quaterniond(q.w, q.x, q.y, q.z);
  };
  const Eigen::Quaterniond total =
      rotation(mount.transform.rotation) * rotation(optical.transform.rotation);
  // The view axis (optical z) lies 30 degrees below base_link's x; optical x points right.
  EXPECT_TRUE((total * Eigen::Vector3d::UnitZ())
                  .isApprox(Eigen::Vector3d(std::sqrt(3.0) / 2.0, 0.0, -0.5), 1e-12));
  EXPECT_TRUE((total * Eigen::Vector3d::UnitX()).isApprox(-Eigen::Vector3d::UnitY(), 1e-12));
}

TEST(Display, EachCameraOfARigHasItsFrames) {
  session::ScenarioOptions options;
  options.ego_rig.preset = rendering::kBench2driveRig;
  const session::VehicleRigs rigs(options);
  const tf2_msgs::TFMessage message = toTfMsg(test::sampleSnapshot(4), &rigs);
  // base_link of two, then camera and optical frame of the ego's six and of the CBV's one.
  ASSERT_EQ(message.transforms.size(), 16U);
  EXPECT_EQ(message.transforms[2].child_frame_id, "ego/camera");
  const auto& mount = message.transforms[4];
  EXPECT_EQ(mount.header.frame_id, "ego/base_link");
  EXPECT_EQ(mount.child_frame_id, "ego/camera_front_left");
  EXPECT_EQ(mount.transform.translation.x, 0.27);
  EXPECT_EQ(mount.transform.translation.y, 0.55);
  EXPECT_EQ(mount.transform.translation.z, 1.6);
  // Turned by 55 degrees to the left about z.
  EXPECT_NEAR(mount.transform.rotation.z, std::sin(27.5 * M_PI / 180.0), 1e-12);
  EXPECT_NEAR(mount.transform.rotation.w, std::cos(27.5 * M_PI / 180.0), 1e-12);
  EXPECT_EQ(message.transforms[5].child_frame_id, "ego/camera_front_left_optical");
  EXPECT_EQ(message.transforms[14].child_frame_id, "bg_7/camera");
}

TEST(Markers, PerceptionShowsVehiclesWaysLinesAndCells) {
  const MarkerArray array = perceptionMarkers(test::samplePerception(), 2.0, 0.2);
  ASSERT_EQ(array.markers.size(), 5U);
  EXPECT_EQ(array.markers[0].action, Marker::DELETEALL);
  const Marker& vehicle = array.markers[1];
  EXPECT_EQ(vehicle.ns, "perceived_vehicles");
  EXPECT_EQ(vehicle.scale.x, 4.0);
  EXPECT_EQ(vehicle.color.a, 0.75F) << "as opaque as its score";
  const Marker& line = array.markers[2];
  EXPECT_EQ(line.ns, "perceived_lines");
  EXPECT_EQ(line.points.size(), 4U) << "two segments as pairs";
  EXPECT_GT(line.color.r, 2 * line.color.b) << "edges are red";
  const Marker& cells = array.markers[3];
  EXPECT_EQ(cells.ns, "occupancy");
  ASSERT_EQ(cells.points.size(), 2U);
  EXPECT_EQ(cells.points[1].x, 2.5) << "in the frame of the ego";
  EXPECT_EQ(cells.pose.position.y, 5.0);
  const Marker& ways = array.markers[4];
  EXPECT_EQ(ways.ns, "forecasts");
  ASSERT_EQ(ways.points.size(), 4U) << "the likeliest way alone, from the vehicle on";
  EXPECT_EQ(ways.points[0].x, 10.0);
  EXPECT_EQ(ways.points[3].x, 12.0);
  for (std::size_t i = 1; i < array.markers.size(); ++i) {
    EXPECT_EQ(array.markers[i].lifetime, ros::Duration(0.5));
    EXPECT_EQ(array.markers[i].header.frame_id, "map");
  }
  EXPECT_EQ(perceptionMarkers({}, 0.0, 0.2).markers.size(), 1U) << "clears what was shown";
}

TEST(Markers, RolloutsAreLinesBySlot) {
  planning::PlannedAction planned{2, "bg_7", {}, {}};
  planned.rollout = {{{{1.0, 2.0}, 5.0, 0.0, 3.0}, {}}, {{{4.0, 2.0}, 6.0, 0.0, 3.0}, {}}};
  const MarkerArray array = rolloutMarkers({planned, {3, "bg_9", {}, {}}}, 0.2);
  ASSERT_EQ(array.markers.size(), 2U);
  EXPECT_EQ(array.markers[0].id, 2);
  EXPECT_EQ(array.markers[0].action, Marker::ADD);
  ASSERT_EQ(array.markers[0].points.size(), 2U);
  EXPECT_EQ(array.markers[0].points[1].x, 4.0);
  EXPECT_GT(array.markers[0].points[1].z, 6.0);
  EXPECT_EQ(array.markers[0].header.stamp, ros::Time(0.2));
  EXPECT_EQ(array.markers[1].action, Marker::DELETE);  // nothing is planned
}

}  // namespace
}  // namespace cdiff::node_graph
