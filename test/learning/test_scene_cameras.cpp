// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/core/exceptions.h"
#include "learning/samples/scene_cameras.h"
#include "learning/samples/scene_file.h"
#include "learning/small_scene.h"
#include "rendering/front_camera.h"

namespace cdiff::learning {
namespace {

rendering::CameraRig sixCameras() {
  rendering::RigOptions options;
  options.preset = rendering::kBench2driveRig;
  return rendering::rigOf(options, {});
}

TEST(SceneCameras, AStoredSceneShowsTheBytesThatTheSessionHad) {
  const Scene scene = test::smallScene(4);
  const Scene read = sceneOf(sceneBytes(scene), "scene");
  SceneCameras cameras(rendering::frontRig({}));
  cameras.open(read);
  const map::RoadNetwork network =
      map::RoadNetwork::fromText(scene.network_text, scene.network_source);
  rendering::FrontCamera live({}, network);
  for (std::size_t i = 0; i < 4; ++i) {
    const auto views = cameras.render(i, "ego");
    ASSERT_EQ(views.size(), 1u);
    EXPECT_EQ(views[0].image.rgb, live.render(scene.decisions[i], *scene.decisions[i].ego()).rgb);
    EXPECT_EQ(views[0].image.tick, scene.decisions[i].tick);
    EXPECT_TRUE(views[0].instances.empty());
  }
}

TEST(SceneCameras, InstancesAreNumberedByTheDecisionsVehicles) {
  const Scene scene = test::smallScene(4);
  SceneCameras cameras(sixCameras());
  cameras.open(scene);
  // "a" drives 30 m ahead of the ego, "b" stands 50 m ahead and 3.5 m to the left: both in the
  // front camera's view, none in another's.
  const auto views = cameras.render(0, "ego", rendering::Labels::kClassesAndInstances);
  ASSERT_EQ(views.size(), 6u);
  const std::vector<int> pixels = rendering::mostPixels(views, scene.decisions[0].vehicles.size());
  ASSERT_EQ(pixels.size(), 3u);
  EXPECT_EQ(scene.decisions[0].vehicles[1].id, "a");
  EXPECT_EQ(pixels[0], 0);
  EXPECT_GT(pixels[1], 10);
  EXPECT_GT(pixels[2], 10);
  for (std::size_t i = 1; i < 6; ++i) {
    for (const std::uint16_t here : views[i].instances) ASSERT_EQ(here, 0) << i;
  }
}

TEST(SceneCameras, SeesFromAMovedPlace) {
  const Scene scene = test::smallScene(4);
  SceneCameras cameras(sixCameras());
  cameras.open(scene);
  traffic::Vehicle moved = *scene.decisions[0].ego();
  moved.state.position.x() = 70.0;  // past "a" and "b", which the back camera now sees
  const auto views = cameras.render(0, moved, rendering::Labels::kClassesAndInstances);
  bool behind = false;
  for (const std::uint16_t here : views[3].instances) behind = behind || here == 2;
  EXPECT_TRUE(behind);
  for (const std::uint16_t here : views[0].instances) ASSERT_EQ(here, 0);
}

TEST(SceneCameras, GoesFromSceneToScene) {
  const Scene small = test::smallScene(4);
  const Scene platoon = test::platoonScene("platoon", 1.0);
  SceneCameras cameras(rendering::frontRig({}));
  cameras.open(small);
  const auto first = cameras.render(2, "ego").front().image;
  cameras.open(platoon);
  EXPECT_NE(cameras.render(2, "ego").front().image.rgb, first.rgb);
  cameras.open(small);
  EXPECT_EQ(cameras.render(2, "ego").front().image.rgb, first.rgb);
}

TEST(SceneCameras, ErrorsNameSceneDecisionAndVehicle) {
  const Scene scene = test::smallScene(4);
  SceneCameras cameras(rendering::frontRig({}));
  EXPECT_THROW(cameras.render(0, "ego"), std::logic_error);
  cameras.open(scene);
  const auto error_of = [&](std::size_t decision, const std::string& vehicle) {
    try {
      cameras.render(decision, vehicle);
    } catch (const core::InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_EQ(error_of(1, "nobody"),
            "scene 'small_seed1', decision 1: no vehicle 'nobody', whose images were asked for");
  EXPECT_EQ(error_of(4, "ego"),
            "scene 'small_seed1' has 4 decisions; the images of decision 4 were asked for");
  EXPECT_THROW(SceneCameras{rendering::CameraRig()}, core::InputError);
}

}  // namespace
}  // namespace cdiff::learning
