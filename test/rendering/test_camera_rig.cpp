// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>

#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/rendering/camera_rig.h"
#include "support/error_text.h"

namespace cdiff::rendering {
namespace {

/// Options of preset "own" with one camera.
RigOptions ownCamera(const RigCamera& camera) {
  RigOptions options;
  options.preset = kOwnRig;
  options.cameras = {camera};
  return options;
}

using test::errorOf;

std::string errorOf(const RigOptions& options) {
  return errorOf([&] { options.validate("ego_rig."); });
}

std::string loadError(const std::string& yaml) {
  RigOptions options;
  return errorOf([&] { core::loadOptions({"rig.yaml", yaml}, options); });
}

CameraRig presetRig(const char* preset) {
  RigOptions options;
  options.preset = preset;
  return rigOf(options, {});
}

TEST(CameraRig, Bench2DrivesSixStandWhereTheReferenceHasThem) {
  // Bench2Drive's agent (x forward, y right, yaw clockwise); here y is left, yaw counter-clockwise.
  const struct {
    const char* name;
    double x, right, z, clockwise, field_of_view;
  } expected[] = {{"front", 0.80, 0.0, 1.60, 0.0, 70.0},
                  {"front_left", 0.27, -0.55, 1.60, -55.0, 70.0},
                  {"front_right", 0.27, 0.55, 1.60, 55.0, 70.0},
                  {"back", -2.0, 0.0, 1.60, 180.0, 110.0},
                  {"back_left", -0.32, -0.55, 1.60, -110.0, 70.0},
                  {"back_right", -0.32, 0.55, 1.60, 110.0, 70.0}};
  const CameraRig rig = presetRig(kBench2driveRig);
  ASSERT_EQ(rig.cameras.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    const RigCamera& camera = rig.cameras[i];
    EXPECT_EQ(camera.name, expected[i].name);
    EXPECT_EQ(camera.x, expected[i].x);
    EXPECT_EQ(camera.y, -expected[i].right);
    EXPECT_EQ(camera.z, expected[i].z);
    EXPECT_NEAR(std::remainder(camera.yaw + expected[i].clockwise, 360.0), 0.0, 1e-12);
    EXPECT_EQ(camera.pitch, 0.0);
    EXPECT_EQ(camera.field_of_view, expected[i].field_of_view);
    EXPECT_EQ(camera.width, 160);
    EXPECT_EQ(camera.height, 96);
  }
}

TEST(CameraRig, FrontThreeAreTheFirstOfTheSix) {
  const CameraRig three = presetRig(kFrontThreeRig);
  CameraRig six = presetRig(kBench2driveRig);
  six.cameras.resize(3);
  EXPECT_EQ(core::dumpOptions(three), core::dumpOptions(six));
}

TEST(CameraRig, FrontIsTheFrontCamera) {
  CameraOptions camera;
  camera.mount_forward = 0.7;
  camera.mount_height = 1.3;
  camera.pitch = 4.0;
  camera.field_of_view = 80.0;
  camera.width = 128;
  camera.height = 64;
  camera.far_distance = 70.0;
  camera.supersampling = 3;
  camera.blind = true;
  const CameraRig rig = rigOf({}, camera);
  ASSERT_EQ(rig.cameras.size(), 1u);
  const RigCamera& front = rig.cameras.front();
  EXPECT_EQ(front.name, "front");
  EXPECT_EQ(front.x, 0.7);
  EXPECT_EQ(front.y, 0.0);
  EXPECT_EQ(front.z, 1.3);
  EXPECT_EQ(front.yaw, 0.0);
  EXPECT_EQ(front.pitch, 4.0);
  EXPECT_EQ(front.field_of_view, 80.0);
  EXPECT_EQ(front.width, 128);
  EXPECT_EQ(front.height, 64);
  EXPECT_EQ(rig.far_distance, 70.0);
  EXPECT_EQ(rig.supersampling, 3);
  EXPECT_TRUE(rig.blind);
}

TEST(CameraRig, PlannerStandsForThePlannersPreset) {
  EXPECT_EQ(rigOf({}, {}, kFrontThreeRig).cameras.size(), 3u);
  RigOptions options;
  options.preset = kBench2driveRig;
  options.width = 320;
  options.height = 180;
  const CameraRig rig = rigOf(options, {}, kFrontThreeRig);
  ASSERT_EQ(rig.cameras.size(), 6u);
  EXPECT_EQ(rig.cameras[4].width, 320);
  EXPECT_EQ(rig.cameras[4].height, 180);
}

TEST(CameraRig, IntrinsicsFollowFromTheFieldOfView) {
  // 80 / tan(35 deg) and 80 / tan(55 deg).
  const CameraRig rig = presetRig(kBench2driveRig);
  EXPECT_NEAR(intrinsicsOf(rig.cameras[1]).focal_length, 114.25184, 1e-5);
  EXPECT_NEAR(intrinsicsOf(rig.cameras[3]).focal_length, 56.01660, 1e-5);
  EXPECT_EQ(intrinsicsOf(rig.cameras[1]).center_x, 79.5);
  EXPECT_EQ(intrinsicsOf(rig.cameras[1]).center_y, 47.5);
}

TEST(CameraRig, ExtrinsicsTurnTheVehiclesFrame) {
  // Looks left (+y): right is forward (+x), so a point 1 m ahead and 3 m left of it, 0.5 m below,
  // lies 1 m right, 0.5 m down, 3 m deep.
  const RigCamera left = {"left", 1.0, 2.0, 1.5, 90.0, 0.0, 90.0, 160, 96};
  const Eigen::Vector3d seen = cameraFromVehicle(left) * Eigen::Vector4d(2.0, 5.0, 1.0, 1.0);
  EXPECT_NEAR((seen - Eigen::Vector3d(1.0, 0.5, 3.0)).norm(), 0.0, 1e-12);
  // f = 80: u = 79.5 + 80 / 3, v = 47.5 + 40 / 3.
  const Eigen::Vector3d pixel = projectionOf(left) * Eigen::Vector4d(2.0, 5.0, 1.0, 1.0);
  EXPECT_NEAR(pixel.x() / pixel.z(), 79.5 + 80.0 / 3.0, 1e-9);
  EXPECT_NEAR(pixel.y() / pixel.z(), 47.5 + 40.0 / 3.0, 1e-9);
  EXPECT_NEAR(pixel.z(), 3.0, 1e-12);
  // 45 degrees down, the point straight below the axis: (0, 0) of the road 1.5 m ahead of the eye.
  const RigCamera down = {"down", 0.0, 0.0, 1.5, 0.0, 45.0, 90.0, 160, 96};
  const Eigen::Vector3d axis = cameraFromVehicle(down) * Eigen::Vector4d(1.5, 0.0, 0.0, 1.0);
  EXPECT_NEAR((axis - Eigen::Vector3d(0.0, 0.0, 1.5 * std::sqrt(2.0))).norm(), 0.0, 1e-12);
}

TEST(CameraRig, LoadsCamerasFromYaml) {
  RigOptions options;
  core::loadOptions({"rig.yaml",
                     "preset: own\ncameras:\n- {name: left, y: 0.9, yaw: 90, width: 64}\n"
                     "- {name: rear, x: -2, yaw: 180, pitch: 3}\n"},
                    options);
  options.validate("ego_rig.");
  ASSERT_EQ(options.cameras.size(), 2u);
  EXPECT_EQ(options.cameras[0].name, "left");
  EXPECT_EQ(options.cameras[0].yaw, 90.0);
  EXPECT_EQ(options.cameras[0].width, 64);
  EXPECT_EQ(options.cameras[1].pitch, 3.0);
  RigOptions again;
  core::loadOptions({"again.yaml", core::dumpOptions(options)}, again);
  EXPECT_EQ(core::dumpOptions(again), core::dumpOptions(options));
  core::overrideOption("cameras=[{name: top, z: 3}]", "--set", again);
  ASSERT_EQ(again.cameras.size(), 1u);
  EXPECT_EQ(again.cameras[0].z, 3.0);
}

TEST(CameraRig, YamlErrorsNameCameraAndKey) {
  EXPECT_EQ(loadError("cameras: [{name: left}, {name: rear, yaw: 400}]"),
            "rig.yaml:1: key 'cameras[rear].yaw' is '400'; expected a number in [-180, 180] deg");
  EXPECT_EQ(loadError("cameras: [{name: left, yaww: 4}]").substr(0, 52),
            "rig.yaml:1: unknown key 'cameras[left].yaww'; the ne");
  EXPECT_EQ(loadError("cameras: [{width: 0}]"),
            "rig.yaml:1: key 'cameras[0].width' is '0'; expected a whole number in [1, 4096] px");
  EXPECT_EQ(loadError("cameras: front").substr(0, 69),
            "rig.yaml:1: key 'cameras' is 'front'; expected a list of groups of ke");
  EXPECT_NE(loadError("cameras: [front]").find("expected a list of groups"), std::string::npos);
  EXPECT_NE(loadError("preset: bench2drive").find("did you mean 'bench2drive_six'"),
            std::string::npos);
}

TEST(CameraRig, RefusesBadRigs) {
  EXPECT_EQ(errorOf(ownCamera({"Left"})),
            "key 'ego_rig.cameras': camera 'Left': its name (key 'name') must be snake_case");
  EXPECT_EQ(errorOf(ownCamera({"left", 0.0, 30.0})),
            "key 'ego_rig.cameras': camera 'left': option 'y' is 30; expected a number in [-20, "
            "20] m");
  RigOptions twice = ownCamera({"left"});
  twice.cameras.push_back({"left"});
  EXPECT_EQ(errorOf(twice),
            "key 'ego_rig.cameras': camera 'left': another camera of the rig has this name (key "
            "'name')");
  RigOptions none;
  none.preset = kOwnRig;
  EXPECT_EQ(errorOf(none), "key 'ego_rig.cameras': the rig has no camera; expected at least one");
  RigOptions many = none;
  for (int i = 0; i < 17; ++i) many.cameras.push_back({"camera_" + std::to_string(i)});
  EXPECT_EQ(errorOf(many), "key 'ego_rig.cameras': the rig has 17 cameras; expected at most 16");
  RigOptions both = ownCamera({"left"});
  both.preset = kFrontThreeRig;
  EXPECT_EQ(errorOf(both),
            "key 'ego_rig.cameras' lists cameras, but 'ego_rig.preset' is 'front_three'; expected "
            "the preset 'own' or no list");
  RigOptions sized = ownCamera({"left"});
  sized.width = 200;
  EXPECT_NE(errorOf(sized).find("'ego_rig.width'"), std::string::npos);
}

TEST(CameraRig, RequirementsNameTheCamera) {
  const CameraRig six = presetRig(kBench2driveRig);
  const RigUse use = {"ego_planner 'x'", "ego_rig"};
  EXPECT_EQ(errorOf([&] { requireCameras(six, {"front", "back_left"}, use); }), "no error");
  EXPECT_EQ(errorOf([&] {
              requireCameras(presetRig(kFrontThreeRig), {"front", "back"}, use);
            }),
            "ego_planner 'x' needs the camera 'back'; the rig of key 'ego_rig' has front, "
            "front_left, front_right; expected a preset or own cameras that hold it");
  std::vector<RigCamera> trained = presetRig(kFrontThreeRig).cameras;
  EXPECT_EQ(errorOf([&] { requireSameCameras(six, trained, use); }), "no error");
  trained[1].yaw = 60.0;
  EXPECT_EQ(errorOf([&] { requireSameCameras(six, trained, use); }),
            "camera 'front_left' of the rig of key 'ego_rig' has yaw 55; ego_planner 'x' was "
            "trained with 60");
  trained[1].yaw = 55.0;
  trained[2].width = 320;
  EXPECT_EQ(errorOf([&] { requireSameCameras(six, trained, use); }),
            "camera 'front_right' of the rig of key 'ego_rig' has width 160; ego_planner 'x' was "
            "trained with 320");
}

}  // namespace
}  // namespace cdiff::rendering
