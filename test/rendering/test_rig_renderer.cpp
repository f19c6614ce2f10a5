// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "e2e_cdiff/core/exceptions.h"
#include "rendering/camera_worlds.h"
#include "rendering/rig_renderer.h"

namespace cdiff::rendering {
namespace {

CameraRig sixCameras() {
  RigOptions options;
  options.preset = kBench2driveRig;
  return rigOf(options, {});
}

/// The rig of the level camera alone.
CameraRig levelRig() { return frontRig(levelCamera()); }

const RenderedView& viewOf(const CameraRig& rig, const std::vector<RenderedView>& views,
                           const std::string& camera) {
  return views.at(static_cast<std::size_t>(rig.find(camera) - rig.cameras.data()));
}

/// Names of the cameras whose images show the vehicle of this number.
std::set<std::string> camerasThatSee(const CameraRig& rig, const std::vector<RenderedView>& views,
                                     std::uint16_t instance) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (const std::uint16_t here : views[i].instances) {
      if (here == instance) names.insert(rig.cameras[i].name);
    }
  }
  return names;
}

TEST(RigRenderer, AKnownPointFallsOnAKnownPixelInEachCamera) {
  const CameraRig rig = sixCameras();
  // From each camera 10 m along its axis, 2 m to its right and on the road, 1.6 m below it:
  // u = 79.5 + 2 f / 10, v = 47.5 + 1.6 f / 10 with f = 80 / tan(35 deg) = 114.25184, of the back
  // camera 80 / tan(55 deg) = 56.01660. The vehicle stands at (100, 50) and heads north, so that
  // forward (x, y) is (100 - y, 50 + x) in the map.
  const struct {
    const char* name;
    double x, y, axis_x, axis_y, focal_length;
  } cases[] = {{"front", 0.80, 0.0, 1.0, 0.0, 114.25184},
               {"front_left", 0.27, 0.55, 0.57357644, 0.81915204, 114.25184},
               {"front_right", 0.27, -0.55, 0.57357644, -0.81915204, 114.25184},
               {"back", -2.0, 0.0, -1.0, 0.0, 56.01660},
               {"back_left", -0.32, 0.55, -0.34202014, 0.93969262, 114.25184},
               {"back_right", -0.32, -0.55, -0.34202014, -0.93969262, 114.25184}};
  traffic::Vehicle vehicle = vehicleAt("ego", 100.0, 50.0, 0.5 * 3.14159265358979323846);
  vehicle.state.elevation = 3.0;
  for (std::size_t i = 0; i < 6; ++i) {
    const auto& one = cases[i];
    ASSERT_EQ(rig.cameras[i].name, one.name);
    const double x = one.x + 10.0 * one.axis_x + 2.0 * one.axis_y;
    const double y = one.y + 10.0 * one.axis_y - 2.0 * one.axis_x;
    const auto pixel = pixelOf(rig.cameras[i], vehicle, {100.0 - y, 50.0 + x, 3.0});
    ASSERT_TRUE(pixel) << one.name;
    EXPECT_NEAR(pixel->x(), 79.5 + 0.2 * one.focal_length, 1e-4) << one.name;
    EXPECT_NEAR(pixel->y(), 47.5 + 0.16 * one.focal_length, 1e-4) << one.name;
    const Eigen::Vector3d projected = projectionOf(rig.cameras[i]) * Eigen::Vector4d(x, y, 0, 1);
    EXPECT_NEAR(projected.x() / projected.z(), pixel->x(), 1e-9) << one.name;
    EXPECT_NEAR(projected.y() / projected.z(), pixel->y(), 1e-9) << one.name;
    EXPECT_FALSE(pixelOf(rig.cameras[i], vehicle, {100.0 + 3.0 * y, 50.0 - 3.0 * x, 3.0}))
        << one.name;
  }
}

TEST(RigRenderer, VehiclesAreSeenByTheCamerasThatLookAtThem) {
  const CameraRig rig = sixCameras();
  RigRenderer renderer(rig, straightRoad());
  const traffic::Vehicle ego = vehicleAt("ego", 0.0, 0.0);
  // Bearings seen from the ego: 0, 55, -55, 180, 110, -110 deg, 15 m away; the sides see +-35 deg
  // of their directions, the back camera +-55.
  const traffic::TrafficSnapshot snapshot =
      snapshotOf({ego, vehicleAt("ahead", 15.0, 0.0), vehicleAt("left", 8.6, 12.3),
                  vehicleAt("right", 8.6, -12.3), vehicleAt("behind", -15.0, 0.0),
                  vehicleAt("left_behind", -5.1, 14.1), vehicleAt("right_behind", -5.1, -14.1)});
  const auto views = renderer.render(snapshot, ego, Labels::kClassesAndInstances);
  using Names = std::set<std::string>;
  EXPECT_EQ(camerasThatSee(rig, views, 1), Names{});  // itself
  EXPECT_EQ(camerasThatSee(rig, views, 2), Names{"front"});
  EXPECT_EQ(camerasThatSee(rig, views, 3), Names{"front_left"});
  EXPECT_EQ(camerasThatSee(rig, views, 4), Names{"front_right"});
  EXPECT_EQ(camerasThatSee(rig, views, 5), Names{"back"});
  EXPECT_EQ(camerasThatSee(rig, views, 6), Names{"back_left"});
  EXPECT_EQ(camerasThatSee(rig, views, 7), Names{"back_right"});
}

TEST(RigRenderer, AVehicleOnTheLeftIsLeftInTheImageOfTheBackRight) {
  // Looking backwards to the right, what lies farther to the vehicle's back is on the right.
  const CameraRig rig = sixCameras();
  RigRenderer renderer(rig, straightRoad());
  const traffic::Vehicle ego = vehicleAt("ego", 0.0, 0.0);
  const traffic::TrafficSnapshot snapshot =
      snapshotOf({ego, vehicleAt("beside", -1.0, -12.0), vehicleAt("farther_back", -9.0, -12.0)});
  const auto views = renderer.render(snapshot, ego, Labels::kClassesAndInstances);
  const RenderedView& view = viewOf(rig, views, "back_right");
  double columns[3] = {0.0, 0.0, 0.0};
  int pixels[3] = {0, 0, 0};
  for (std::size_t i = 0; i < view.instances.size(); ++i) {
    const int seen = std::max(0, view.instances[i] - 1);
    columns[seen] += static_cast<double>(i % 160);
    ++pixels[seen];
  }
  ASSERT_GT(pixels[1], 20);
  ASSERT_GT(pixels[2], 20);
  EXPECT_LT(columns[1] / pixels[1], columns[2] / pixels[2] - 20.0);
}

TEST(RigRenderer, InstancesMarkExactlyTheVehicle) {
  RigRenderer renderer(levelRig(), straightRoad());
  const traffic::Vehicle ego = vehicleAt("ego", 0.0, 0.0);
  const traffic::TrafficSnapshot snapshot =
      snapshotOf({ego, vehicleAt("hidden", 60.0, 0.0), vehicleAt("other", 12.75, 0.0)});
  const RenderedView view = renderer.render(snapshot, ego, Labels::kClassesAndInstances).front();
  ASSERT_EQ(view.instances.size(), 160u * 96u);
  // Its rear at depth 10 spans columns 79.5 +- 7.2; a pixel's samples lie 0.25 beside its middle:
  // columns 73 to 86. Upwards it ends at the roof's rear edge, 1.5 m high at depth 10.63: row
  // 47.5 - 0.753 = 46.747, so that both samples of row 47 lie on it. Downwards it ends where the
  // rear axle's wheels touch the road at depth 10.54: row 47.5 + 10.626 = 58.126, so that the upper
  // samples of row 58 lie on it, a tie that the vehicle wins. The far vehicle is behind it.
  const auto at = [&](int column, int row) {
    return view.instances[static_cast<std::size_t>(row * 160 + column)];
  };
  for (int column = 0; column < 160; ++column)
    EXPECT_EQ(at(column, 56), column >= 73 && column <= 86 ? 3 : 0) << column;
  for (int row = 0; row < 96; ++row) EXPECT_EQ(at(79, row), row >= 47 && row <= 58 ? 3 : 0) << row;
  for (int row = 0; row < 96; ++row) {
    for (int column = 0; column < 160; ++column) {
      const bool inside = column >= 73 && column <= 86 && row >= 47 && row <= 58;
      EXPECT_TRUE(inside || at(column, row) == 0) << column << " " << row;
    }
  }
}

TEST(RigRenderer, ClassesSayWhatAPixelShows) {
  RigRenderer renderer(levelRig(), signaledLane(10.5));
  const traffic::Vehicle ego = vehicleAt("ego", 0.0, 0.0);
  traffic::TrafficSnapshot snapshot = snapshotOf({ego, vehicleAt("other", 12.0, 8.0)});
  snapshot.signals = {{"light", "rr"}};
  const RenderedView view = renderer.render(snapshot, ego, Labels::kClassesAndInstances).front();
  const auto at = [&](int column, int row) {
    return view.classes[static_cast<std::size_t>(row * 160 + column)];
  };
  EXPECT_EQ(at(10, 5), SceneClass::kSky);
  EXPECT_EQ(at(150, 70), SceneClass::kTerrain);  // the lane is 4 m wide: 32 columns at depth 10
  EXPECT_EQ(at(79, 80), SceneClass::kRoad);
  EXPECT_EQ(at(79, 59), SceneClass::kMarking);  // stop line at depths 9.5 to 10
  EXPECT_EQ(at(79, 36), SceneClass::kSignal);   // the lamp's middle
  for (std::size_t i = 0; i < view.classes.size(); ++i)
    EXPECT_EQ(view.classes[i] == SceneClass::kVehicle, view.instances[i] != 0) << i;
}

TEST(RigRenderer, LightStatesAreSeenByTheSixCameras) {
  const CameraRig rig = sixCameras();
  RigRenderer renderer(rig, signaledLane(10.5));
  const traffic::Vehicle ego = vehicleAt("ego", 0.0, 0.0);
  traffic::TrafficSnapshot snapshot = snapshotOf({ego});
  const auto see = [&](const char* state) {
    snapshot.signals = {{"light", state}};
    return renderer.render(snapshot, ego);
  };
  // The lamp stands 2.5 m behind the lane's end: depth 12.2 of the front camera, its middle 1.5 m
  // above the eye, bulbs 0.54 m apart: rows 47.5 - 9.365 * (2.04, 1.5, 0.96).
  EXPECT_EQ(pixelAt(see("rr")[0].image, 79, 28), (Pixel{255, 40, 32}));
  EXPECT_EQ(pixelAt(see("ry")[0].image, 79, 33), (Pixel{255, 208, 24}));
  EXPECT_EQ(pixelAt(see("rG")[0].image, 79, 38), (Pixel{40, 240, 96}));
  // Past it, the back camera sees the housing from behind, in no color.
  const traffic::Vehicle passed = vehicleAt("ego", 30.0, 0.0);
  snapshot.signals = {{"light", "rr"}};
  const auto red = renderer.render(snapshot, passed);
  snapshot.signals = {{"light", "rG"}};
  const auto green = renderer.render(snapshot, passed);
  // Its stop line lies at depth 17.75, row 47.5 + 56.0166 * 1.6 / 17.75 = 52.5, and has the color.
  EXPECT_EQ(pixelAt(red[3].image, 79, 43), pixelAt(green[3].image, 79, 43));
  EXPECT_NE(red[3].image.rgb, green[3].image.rgb);
}

TEST(RigRenderer, ACamerasImageDoesNotDependOnTheOthers) {
  const map::RoadNetwork network = signaledLane(30.0);
  const traffic::Vehicle ego = vehicleAt("ego", 0.0, 0.0, 0.03);
  traffic::TrafficSnapshot snapshot =
      snapshotOf({ego, vehicleAt("a", 15, 1.3, 0.4), vehicleAt("b", -9, -3, 2.0)});
  snapshot.signals = {{"light", "rr"}};
  snapshot.tick = 17;
  CameraRig rig = sixCameras();
  rig.cameras.push_back(frontCamera({}));
  rig.cameras.back().name = "windscreen";
  RigRenderer all(rig, network);
  const auto views = all.render(snapshot, ego);
  ASSERT_EQ(views.size(), 7u);
  for (std::size_t i = 0; i < views.size(); ++i) {
    CameraRig one = rig;
    one.cameras = {rig.cameras[i]};
    RigRenderer alone(one, all);
    EXPECT_EQ(alone.render(snapshot, ego).front().image.rgb, views[i].image.rgb) << i;
    EXPECT_EQ(views[i].image.tick, 17u);
    EXPECT_TRUE(views[i].classes.empty());
    EXPECT_TRUE(views[i].instances.empty());
  }
  FrontCamera front({}, network);
  EXPECT_EQ(front.render(snapshot, ego).rgb, views.back().image.rgb);
}

TEST(RigRenderer, LabelsChangeNoImage) {
  RigRenderer renderer(sixCameras(), signaledLane(30.0));
  const traffic::Vehicle ego = vehicleAt("ego", 0.0, 0.0, 0.03);
  const traffic::TrafficSnapshot snapshot =
      snapshotOf({ego, vehicleAt("a", 15, 1.3, 0.4), vehicleAt("b", -9, -3, 2.0)});
  const auto plain = renderer.render(snapshot, ego);
  const auto labeled = renderer.render(snapshot, ego, Labels::kClassesAndInstances);
  const auto again = renderer.render(snapshot, ego);
  for (std::size_t i = 0; i < plain.size(); ++i) {
    EXPECT_EQ(labeled[i].image.rgb, plain[i].image.rgb) << i;
    EXPECT_EQ(again[i].image.rgb, plain[i].image.rgb) << i;
    EXPECT_TRUE(again[i].classes.empty());
  }
}

TEST(RigRenderer, ABlindRigKeepsItsLabels) {
  CameraRig rig = levelRig();
  const traffic::Vehicle ego = vehicleAt("ego", 0.0, 0.0);
  const traffic::TrafficSnapshot snapshot = snapshotOf({ego, vehicleAt("other", 12.75, 0.0)});
  RigRenderer seeing(rig, straightRoad());
  rig.blind = true;
  RigRenderer blind(rig, straightRoad());
  const auto seen = seeing.render(snapshot, ego, Labels::kClassesAndInstances).front();
  const auto gray = blind.render(snapshot, ego, Labels::kClassesAndInstances).front();
  EXPECT_EQ(gray.image.rgb, std::vector<std::uint8_t>(gray.image.rgb.size(), 128));
  EXPECT_EQ(gray.instances, seen.instances);
  EXPECT_EQ(gray.classes, seen.classes);
}

TEST(RigRenderer, CountsThePixelsOfVehiclesInTheirBestView) {
  const CameraRig rig = sixCameras();
  RigRenderer renderer(rig, straightRoad());
  const traffic::Vehicle ego = vehicleAt("ego", 0.0, 0.0);
  const traffic::TrafficSnapshot snapshot = snapshotOf(
      {ego, vehicleAt("near", 12.0, 0.0), vehicleAt("far", 80.0, -4.0), vehicleAt("beside", 5, 9)});
  const auto views = renderer.render(snapshot, ego, Labels::kClassesAndInstances);
  const std::vector<int> pixels = mostPixels(views, snapshot.vehicles.size());
  ASSERT_EQ(pixels.size(), 4u);
  EXPECT_EQ(pixels[0], 0);
  EXPECT_GT(pixels[1], 200);
  EXPECT_LT(pixels[2], 20);  // 1.8 x 1.5 m at 80 m: 2.6 x 2.1 pixels
  EXPECT_GT(pixels[2], 0);
  int left = 0;
  for (const std::uint16_t here : viewOf(rig, views, "front_left").instances) left += here == 4;
  EXPECT_EQ(pixels[3], left);
}

TEST(RigRenderer, RefusesBadRigs) {
  CameraRig rig = levelRig();
  rig.cameras.front().width = 0;
  EXPECT_THROW(RigRenderer(rig, straightRoad()), core::InputError);
  EXPECT_THROW(RigRenderer(CameraRig(), straightRoad()), core::InputError);
}

}  // namespace
}  // namespace cdiff::rendering
