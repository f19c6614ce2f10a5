// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "rendering/range_sensor.h"
#include "support/error_text.h"
#include "support/network_text.h"
#include "support/snapshot_builder.h"

namespace cdiff::rendering {
namespace {

constexpr float kNothing = std::numeric_limits<float>::infinity();

/// A road of 4 m along the x axis from -100 to 100 m.
map::RoadNetwork road() {
  return test::NetworkText().edge("road", {"-100,0,0 100,0,0"}, "a", "b").network();
}

/// The same, and a bridge across it, 6 m above.
map::RoadNetwork roadAndBridge() {
  return test::NetworkText()
      .edge("road", {"-100,0,0 100,0,0"}, "a", "b")
      .edge("bridge", {"30,-80,6 30,80,6"}, "c", "d")
      .network();
}

RangeSensorOptions oneRing(double elevation = 0.0) {
  RangeSensorOptions options = RangeSensorOptions::laser();
  options.lowest = options.highest = elevation;
  return options;
}

/// With 720 beams: the one at this angle from the heading [deg].
std::size_t beamAt(double degrees) {
  return static_cast<std::size_t>(std::lround((degrees + 180.0) * 2.0)) % 720;
}

TEST(RangeSensor, MeasuresTheNearSidesOfBoxes) {
  RangeSensor sensor(oneRing(), road());
  traffic::TrafficSnapshot snapshot = test::snapshotWithEgo(7, {});
  snapshot.vehicles.push_back(test::vehicle("ahead", {20.0, 0.0}));
  snapshot.vehicles.push_back(test::vehicle("behind_it", {40.0, 0.0}));
  snapshot.vehicles.push_back(test::vehicle("across", {0.0, 10.0, 90.0}));
  snapshot.vehicles.push_back(test::vehicle("far", {-90.0, 0.0}));
  const RangeScan scan = sensor.scan(snapshot, "ego");
  EXPECT_EQ(scan.tick, 7U);
  ASSERT_EQ(scan.ranges.size(), 720U);
  // Boxes of 4.5 m x 1.8 m: sides at 20 - 2.25 m, and at 10 - 2.25 m of the one that is turned.
  EXPECT_NEAR(scan.ranges[beamAt(0.0)], 17.75, 1e-5);
  EXPECT_NEAR(scan.ranges[beamAt(90.0)], 7.75, 1e-5);
  EXPECT_EQ(scan.ranges[beamAt(-90.0)], kNothing);
  EXPECT_EQ(scan.ranges[beamAt(180.0)], kNothing) << "90 m are out of its range";
  // The side at 17.75 m is 0.9 m to either side: atan(0.9 / 17.75) = 2.9 degrees.
  EXPECT_LT(scan.ranges[beamAt(2.5)], kNothing);
  EXPECT_EQ(scan.ranges[beamAt(3.5)], kNothing);
}

TEST(RangeSensor, TurnsWithItsVehicle) {
  RangeSensor sensor(oneRing(), road());
  traffic::TrafficSnapshot snapshot = test::snapshotWithEgo(0, {0.0, 0.0, 30.0});
  snapshot.vehicles.push_back(test::vehicle("east", {20.0, 0.0}));
  const RangeScan scan = sensor.scan(snapshot, "ego");
  EXPECT_NEAR(scan.ranges[beamAt(-30.0)], 17.75, 1e-5);
  EXPECT_EQ(scan.ranges[beamAt(0.0)], kNothing);
  // It stands on the other vehicle's as well as on the ego's.
  EXPECT_NEAR(sensor.scan(snapshot, "east").ranges[beamAt(180.0)], 20.0 - 2.25, 1.0);
}

TEST(RangeSensor, SeesTheRoadAndNothingBesideIt) {
  RangeSensor sensor(oneRing(-0.1), road());
  const RangeScan scan = sensor.scan(test::snapshotWithEgo(0, {}), "ego");
  // 0.6 m above the road: 0.6 / sin(0.1) along it; 6 m to the side there is no road any more.
  EXPECT_NEAR(scan.ranges[beamAt(0.0)], 0.6 / std::sin(0.1), 1e-4);
  EXPECT_NEAR(scan.ranges[beamAt(180.0)], 0.6 / std::sin(0.1), 1e-4);
  EXPECT_EQ(scan.ranges[beamAt(90.0)], kNothing);
}

TEST(RangeSensor, KeepsLevelsApart) {
  RangeSensor level(oneRing(), roadAndBridge());
  traffic::TrafficSnapshot snapshot = test::snapshotWithEgo(0, {});
  snapshot.vehicles.push_back(test::vehicle("on_the_bridge", {30.0, 0.0, 90.0, 0.0, 6.0}));
  EXPECT_EQ(level.scan(snapshot, "ego").ranges[beamAt(0.0)], kNothing);
  // Upward by atan((6.5 - 0.6) / 29.1): the near side of the box, 0.5 m above the deck.
  RangeSensor up(oneRing(std::atan2(5.9, 29.1)), roadAndBridge());
  EXPECT_NEAR(up.scan(snapshot, "ego").ranges[beamAt(0.0)], std::hypot(5.9, 29.1), 1e-3);
}

TEST(RangeSensor, PointsLieOnWhatWasHit) {
  RangeSensor sensor(RangeSensorOptions::lidar(), road());
  traffic::TrafficSnapshot snapshot = test::snapshotWithEgo(0, {3.0, 0.0});
  snapshot.vehicles.push_back(test::vehicle("ahead", {23.0, 0.0}));
  const RangeScan scan = sensor.scan(snapshot, "ego");
  const std::vector<Eigen::Vector3f> points = sensor.points(scan);
  int on_vehicle = 0;
  int on_road = 0;
  for (const Eigen::Vector3f& point : points) {
    on_vehicle += std::abs(point.x() - 17.75F) < 1e-3F && point.z() > 0.01F && point.z() < 1.51F;
    on_road += std::abs(point.z()) < 1e-3F;
    EXPECT_LE(std::abs(point.y()), 2.3F) << "the road is 4.5 m wide with its margins";
  }
  EXPECT_GT(on_vehicle, 10);
  EXPECT_GT(on_road, 100);
  EXPECT_EQ(sensor.scan(snapshot, "ego").ranges, scan.ranges);
}

TEST(RangeSensor, AVehicleThatWasRemovedHasNone) {
  RangeSensor sensor(oneRing(), road());
  traffic::TrafficSnapshot snapshot = test::snapshotWithEgo(12, {});
  snapshot.removed = {"bg_1"};
  const std::string error = test::errorOf([&] { sensor.scan(snapshot, "bg_1"); });
  EXPECT_NE(error.find("vehicle 'bg_1': tick 12 does not hold it"), std::string::npos) << error;
}

TEST(RangeSensor, RefusesBeamsThatMakeNoScan) {
  const auto error = [](RangeSensorOptions options) {
    return test::errorOf([&] { options.validate("ego.lidar."); });
  };
  RangeSensorOptions options = RangeSensorOptions::lidar();
  EXPECT_EQ(error(options), "no error");
  options.highest = options.lowest - 0.1;
  EXPECT_NE(error(options).find("ego.lidar.lowest"), std::string::npos) << error(options);
  options = RangeSensorOptions::laser();
  options.highest = 0.1;
  EXPECT_NE(error(options).find("the same for one ring"), std::string::npos) << error(options);
  options = RangeSensorOptions::lidar();
  options.rings = 128;
  options.beams = 4096;
  EXPECT_NE(error(options).find("524288 beams"), std::string::npos) << error(options);
}

}  // namespace
}  // namespace cdiff::rendering
