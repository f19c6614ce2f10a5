// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <set>

#include "node_graph/messages/display.h"
#include "node_graph/messages/front_view.h"
#include "node_graph/messages/map_markers.h"
#include "node_graph/messages/markers.h"
#include "node_graph/messages/plan_markers.h"
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

const session::SessionSetup& crossing() {
  static const session::SessionSetup setup(session::loadScenario("crossing_left_turn"));
  return setup;
}

/// The first of a namespace; fails without one.
Marker markerOf(const MarkerArray& array, const std::string& marker_namespace) {
  for (const Marker& marker : array.markers) {
    if (marker.ns == marker_namespace) return marker;
  }
  ADD_FAILURE() << "no marker of " << marker_namespace;
  return {};
}

/// Ego at 5 m/s toward +x, a CBV 20 m ahead that comes toward it as fast, a background vehicle.
traffic::TrafficSnapshot headOn() {
  traffic::TrafficSnapshot snapshot = test::sampleSnapshot(4);
  snapshot.contacts.clear();
  snapshot.vehicles[0].state = {{0.0, 0.0}, 0.0, 0.0, 5.0};
  snapshot.vehicles[1].state = {{20.0, 0.0}, 0.0, M_PI, 5.0};
  snapshot.vehicles[2].state = {{0.0, 30.0}, 0.0, 0.0, 0.0};
  return snapshot;
}

MarkerArray build(SessionMarkers& markers, const traffic::TrafficSnapshot& snapshot,
                  const cbv::CbvSelection* selection = nullptr,
                  const std::vector<planning::PlannedAction>* actions = nullptr) {
  session::TickRecord record;
  record.snapshot = &snapshot;
  record.selection = selection;
  record.actions = actions;
  return markers.build(record);
}

/// The same of a session that shows nothing else.
MarkerArray built(const traffic::TrafficSnapshot& snapshot,
                  const cbv::CbvSelection* selection = nullptr,
                  const std::vector<planning::PlannedAction>* actions = nullptr) {
  SessionMarkers markers(crossing());
  return build(markers, snapshot, selection, actions);
}

TEST(Markers, OnlyTheFirstArrayClearsAndEveryIdIsItsOwn) {
  SessionMarkers markers(crossing());
  cbv::CbvSelection selection;
  selection.assignments.resize(2);
  selection.assignments[1].slot = 1;
  for (cbv::CbvAssignment& assignment : selection.assignments)
    assignment.conflict_aware_route = crossing().egoRoute();
  selection.rejected = {{"bg_9", "too_far", 0.0}};
  const MarkerArray first = build(markers, test::sampleSnapshot(0));
  const MarkerArray second = build(markers, test::sampleSnapshot(2), &selection);
  EXPECT_EQ(first.markers.front().action, Marker::DELETEALL);
  std::set<std::pair<std::string, int>> ids;
  for (const Marker& marker : second.markers) {
    EXPECT_EQ(marker.action, Marker::ADD);
    EXPECT_EQ(marker.lifetime, ros::Duration(0.5));
    EXPECT_EQ(marker.header.frame_id, "map");
    EXPECT_TRUE(ids.emplace(marker.ns, marker.id).second) << marker.ns << marker.id;
    EXPECT_TRUE(marker.colors.empty() || marker.colors.size() == marker.points.size()) << marker.ns;
  }
  EXPECT_EQ(count(second, "vehicles"), 3);
  EXPECT_EQ(count(second, "labels"), 2);  // ego and CBV
  EXPECT_EQ(count(second, "traffic_labels"), 1);
}

TEST(Markers, RolesHaveTheirColorsAndLabelsNameIdAndSpeed) {
  SessionMarkers markers(crossing());
  const MarkerArray array = build(markers, headOn());
  std::vector<Marker> vehicles;
  std::vector<std::string> texts;
  for (const Marker& marker : array.markers) {
    if (marker.ns == "vehicles") vehicles.push_back(marker);
    if (marker.ns == "labels" || marker.ns == "traffic_labels") texts.push_back(marker.text);
  }
  ASSERT_EQ(vehicles.size(), 3U);                           // ego, CBV, background
  EXPECT_GT(vehicles[0].color.r, 2 * vehicles[0].color.b);  // red
  EXPECT_GT(vehicles[1].color.b, 2 * vehicles[1].color.g);  // purple: red and blue
  EXPECT_GT(vehicles[1].color.r, 2 * vehicles[1].color.g);
  EXPECT_GT(vehicles[2].color.b, 2 * vehicles[2].color.r);  // blue
  ASSERT_EQ(texts.size(), 3U);
  const auto says = [&](const std::string& part) {
    return std::any_of(texts.begin(), texts.end(), [&](const std::string& text) {
      return text.find(part) != std::string::npos;
    });
  };
  for (const char* part : {"EGO", "5.0 m/s", "bg_7", "bg_9"}) EXPECT_TRUE(says(part)) << part;
}

TEST(Markers, AnArrowheadOnTheRoofPointsAhead) {
  const MarkerArray array = built(headOn());
  const Marker headings = markerOf(array, "headings");
  ASSERT_EQ(headings.points.size(), 9U);  // a triangle of each vehicle, tip first
  EXPECT_GT(headings.points[0].x, headings.points[1].x) << "the ego drives toward +x";
  EXPECT_LT(headings.points[3].x, headings.points[4].x) << "the CBV toward -x";
  EXPECT_GT(headings.points[0].z, headOn().vehicles[0].dimensions.height);
}

TEST(Markers, SelectionShowsConflictPointAndRoute) {
  cbv::CbvSelection selection;
  selection.assignments.resize(1);
  selection.assignments[0].vehicle_id = "bg_7";
  selection.assignments[0].conflict_point.ego_arrival = 3.25;
  selection.assignments[0].conflict_point.cbv_arrival = 4.0;
  selection.assignments[0].interaction_score = 0.75;
  selection.assignments[0].conflict_aware_route = crossing().egoRoute();
  selection.rejected = {{"bg_9", "outranked", 0.5}, {"bg_8", "too_far", 0.0}};
  const MarkerArray array = built(headOn(), &selection);
  EXPECT_EQ(count(array, "conflict_points"), 1);
  EXPECT_EQ(count(array, "conflict_aware_routes"), 1);
  EXPECT_EQ(count(array, "cbv_goals"), 1);
  EXPECT_NE(markerOf(array, "conflict_labels").text.find("4.0 s"), std::string::npos);
  // Who was rejected and is there, then who was chosen.
  ASSERT_EQ(count(array, "candidates"), 2);
  EXPECT_EQ(markerOf(array, "candidates").text, "0.50 outranked");
}

TEST(Markers, TimeToCollisionStandsBetweenEgoAndCbv) {
  const traffic::TrafficSnapshot snapshot = headOn();
  const MarkerArray array = built(snapshot);
  const Marker line = markerOf(array, "ttc");
  ASSERT_EQ(line.points.size(), 2U);
  EXPECT_EQ(line.points[0].x, 0.0);
  EXPECT_EQ(line.points[1].x, 20.0);
  // Boxes of 4.3 m length 20 m apart: a gap of 15.7 m that closes with 10 m/s.
  EXPECT_EQ(markerOf(array, "ttc_labels").text, "TTC 1.6 s, gap 15.7 m");
}

TEST(Markers, TrailsFollowTheDrivenVehicles) {
  SessionMarkers markers(crossing());
  traffic::TrafficSnapshot snapshot = headOn();
  EXPECT_EQ(count(build(markers, snapshot), "trails"), 0);
  snapshot.time += 0.1;
  for (traffic::Vehicle& vehicle : snapshot.vehicles) vehicle.state.position.y() += 1.0;
  const Marker trails = markerOf(build(markers, snapshot), "trails");
  ASSERT_EQ(trails.points.size(), 4U) << "one piece of ego and CBV each";
  EXPECT_EQ(trails.points[0].y, 0.0);
  EXPECT_EQ(trails.points[1].y, 1.0);
  snapshot.time += 10.0;
  EXPECT_EQ(count(build(markers, snapshot), "trails"), 0) << "older ones are gone";
}

TEST(Markers, AContactBetweenDecisionsStaysVisible) {
  SessionMarkers markers(crossing());
  traffic::TrafficSnapshot snapshot = headOn();
  snapshot.contacts = {{"bg_7", "ego"}};
  markers.note(snapshot);
  snapshot.contacts.clear();
  snapshot.time += 1.0;
  markers.note(snapshot);
  const MarkerArray array = build(markers, snapshot);
  EXPECT_EQ(markerOf(array, "contacts").pose.position.x, 10.0) << "in the middle";
  snapshot.time += 10.0;
  markers.note(snapshot);
  EXPECT_EQ(count(build(markers, snapshot), "contacts"), 0);
}

/// Which light controls a lane of the network.
std::string lightOf(const map::RoadNetwork& network) {
  for (const map::Lane& lane : network.lanes()) {
    for (const map::LaneLink& link : lane.next) {
      if (!link.signal_id.empty()) return link.signal_id;
    }
  }
  return {};
}

TEST(Markers, StopLinesHaveTheColorsOfTheirLights) {
  SessionMarkers markers(crossing());
  traffic::TrafficSnapshot snapshot = headOn();
  for (const char letter : {'r', 'G'}) {
    snapshot.signals = {{lightOf(crossing().network()), std::string(64, letter)}};
    const Marker lines = markerOf(build(markers, snapshot), "signals");
    const auto lit = [&](const std_msgs::ColorRGBA& color) {
      return letter == 'r' ? color.r > 2 * color.g : color.g > 2 * color.r;
    };
    EXPECT_TRUE(std::any_of(lines.colors.begin(), lines.colors.end(), lit)) << letter;
  }
}

TEST(Markers, TheMapHasRoadsMarkingsRouteAndGoal) {
  const MarkerArray map = mapMarkers(crossing());
  EXPECT_EQ(map.markers.front().action, Marker::DELETEALL);
  for (const char* list : {"surfaces", "markings"}) {
    const Marker marker = markerOf(map, list);
    EXPECT_GT(marker.points.size(), 300U) << list;
    EXPECT_EQ(marker.points.size() % 3, 0U) << list;
    EXPECT_EQ(marker.colors.size(), marker.points.size()) << list;
  }
  const auto& points = crossing().egoRoute().path().points();
  EXPECT_EQ(markerOf(map, "ego_route").points.size(), points.size());
  EXPECT_EQ(markerOf(map, "ego_goal").pose.position.x, points.back().x());
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

TEST(Markers, PlansAreLinesBySlotInTheColorOfTheStrongestObjective) {
  planning::PlannedAction planned{2, "bg_7", {}, {}};
  planned.rollout = {{{{1.0, 2.0}, 5.0, 0.0, 3.0}, {}}, {{{4.0, 2.0}, 6.0, 0.0, 3.0}, {}}};
  planned.guidance.objectives = {{"speed", 1.0, 0.0, 0.5}, {"collision_seeking", 1.0, 0.0, 2.0}};
  const MarkerArray array = planMarkers({planned, {3, "bg_9", {}, {}}}, test::sampleSnapshot(4));
  ASSERT_EQ(count(array, "rollouts"), 1) << "nothing is planned for bg_9";
  const Marker line = markerOf(array, "rollouts");
  EXPECT_EQ(line.id, 2);
  ASSERT_EQ(line.points.size(), 2U);
  EXPECT_EQ(line.points[1].x, 4.0);
  EXPECT_GT(line.points[1].z, 6.0);
  EXPECT_EQ(line.header.stamp, ros::Time(0.2));
  const MarkerColor color = objectiveColor("collision_seeking");
  EXPECT_EQ(line.color.g, color.green);
  EXPECT_NE(line.color.g, objectiveColor("speed").green);
}

TEST(Markers, WordsSayWhatACbvIntends) {
  planning::PlannedAction planned{2, "bg_7", {}, {}};
  planned.rollout = {{{{1.0, 2.0}, 5.0, 0.0, 3.0}, {}}, {{{4.0, 2.0}, 6.0, 0.0, 3.0}, {}}};
  planned.guidance.objectives = {{"speed", 1.0, 0.0, 0.5}, {"collision_seeking", 1.0, 0.0, 2.0}};
  const std::vector<planning::PlannedAction> actions = {planned};
  const traffic::TrafficSnapshot snapshot = headOn();
  EXPECT_EQ(markerOf(built(snapshot, nullptr, &actions), "plan_labels").text,
            "plan of bg_7: 3.0 m/s in 0.2 s, pulled by collision_seeking");
}

TEST(Labels, OneThatWouldCoverAnotherMovesAndIsLedBack) {
  LabelRoom room;
  Labels labels("names", &room);
  labels.add(0, "first", {10.0, 5.0, 1.0}, 2.0, marker_color::kWhite);
  labels.add(1, "second", {10.0, 5.0, 1.0}, 2.0, marker_color::kWhite);
  const std::vector<Marker> markers = labels.markers();
  const Marker& first = markers[markers.size() - 2];
  const Marker& second = markers.back();
  EXPECT_EQ(first.pose.position.y, 5.0);
  EXPECT_EQ(second.pose.position.x, 10.0);
  // Plates of 1.24 times the size lie above each other at the earliest.
  EXPECT_GE(std::abs(second.pose.position.y - 5.0), 1.24 * 2.0);
}

TEST(Markers, TheBetterACandidateTheBrighter) {
  planning::PlannedAction planned{0, "bg_7", {}, {}};
  planned.candidates = {{{{0.0, 0.0}, {1.0, 0.0}}, -2.0, false},
                        {{{0.0, 1.0}, {1.0, 1.0}}, 3.0, true}};
  planned.attended = {{"ego", 0.5}, {"bg_9", 0.01}};
  const MarkerArray array = planMarkers({planned}, test::sampleSnapshot(4));
  const Marker lines = markerOf(array, "plan_candidates");
  ASSERT_EQ(lines.points.size(), 4U);
  EXPECT_LT(lines.colors[0].a, lines.colors[2].a);
  EXPECT_EQ(lines.colors[2].a, 1.0F);
  EXPECT_EQ(count(array, "attention"), 1) << "of 2 %, at least";
  EXPECT_EQ(markerOf(array, "attention").scale.x, 0.6);
}

TEST(FrontView, APlanIsDrawnWhereTheCameraSeesIt) {
  rendering::RigCamera camera;  // 1.4 m above the road, 0.5 m ahead of the box's middle
  traffic::Vehicle vehicle;
  vehicle.state = {{10.0, 5.0}, 0.0, M_PI / 2.0, 0.0};
  // 10 m ahead of the camera and 2 m to its left, then behind it. 160 px and 90 degrees make a
  // focal length of 80 px: u = 79.5 - 80 * 2 / 10, v = 47.5 + 80 * 1.4 / 10.
  const auto pixels = projectedRollout(
      camera, vehicle, {{{{8.0, 15.5}, 0.0, 0.0, 0.0}, {}}, {{{10.0, 0.0}, 0.0, 0.0, 0.0}, {}}});
  ASSERT_EQ(pixels.size(), 1U);
  EXPECT_NEAR(pixels[0].x(), 63.5, 1e-9);
  EXPECT_NEAR(pixels[0].y(), 58.7, 1e-9);
}

TEST(FrontView, ShowsTheEgosViewBeforeTheFirstCbv) {
  FrontView view(crossing());
  traffic::TrafficSnapshot snapshot = headOn();
  const sensor_msgs::Image with_cbv = view.draw(snapshot, nullptr);
  EXPECT_EQ(with_cbv.header.frame_id, "bg_7/camera_optical");
  EXPECT_EQ(with_cbv.data.size(), 3U * with_cbv.width * with_cbv.height);
  snapshot.vehicles.erase(snapshot.vehicles.begin() + 1);
  const sensor_msgs::Image without = view.draw(snapshot, nullptr);
  EXPECT_EQ(without.header.frame_id, "ego/camera_optical");
  EXPECT_NE(without.data, with_cbv.data);
}

TEST(Display, AFrameFollowsWhoIsInASlotAndTheEgoBefore) {
  const traffic::TrafficSnapshot snapshot = headOn();
  const auto cbv = slotTransform(snapshot, 1);
  ASSERT_TRUE(cbv);
  EXPECT_EQ(cbv->child_frame_id, "cbv_1/base_link");
  EXPECT_EQ(cbv->transform.translation.x, 20.0);
  EXPECT_EQ(slotTransform(snapshot, 0)->transform.translation.x, 0.0) << "nobody is in slot 0";
  EXPECT_FALSE(slotTransform({}, 0));
}

}  // namespace
}  // namespace cdiff::node_graph
