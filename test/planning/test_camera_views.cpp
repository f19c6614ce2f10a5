// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/planning/camera_views.h"

namespace cdiff::planning {
namespace {

rendering::CameraRig rigOf(const std::vector<std::string>& names) {
  rendering::CameraRig rig;
  for (const std::string& name : names) {
    rig.cameras.emplace_back();
    rig.cameras.back().name = name;
  }
  return rig;
}

// Images come in the rig's order.
TEST(CameraViews, FindsTheImageOfACamera) {
  const rendering::CameraRig rig = rigOf({"front", "left", "rear"});
  const traffic::CameraImage front, left, rear;
  CameraViews views{&rig, {&front, &left, &rear}};
  EXPECT_EQ(views.find("front"), &front);
  EXPECT_EQ(views.find("left"), &left);
  EXPECT_EQ(views.find("rear"), &rear);
  EXPECT_EQ(views.find("right"), nullptr);
  EXPECT_EQ(views.missing(), "");
}

TEST(CameraViews, NamesTheFirstCameraWithoutAnImage) {
  const rendering::CameraRig rig = rigOf({"front", "left", "rear"});
  const traffic::CameraImage image;
  EXPECT_EQ((CameraViews{&rig, {&image, nullptr, nullptr}}.missing()), "left");
  EXPECT_EQ((CameraViews{&rig, {&image, &image}}.missing()), "rear") << "one too few";
  EXPECT_EQ((CameraViews{&rig, {}}.missing()), "front");
  EXPECT_EQ((CameraViews{nullptr, {&image}}.missing()), "");
  EXPECT_EQ((CameraViews{nullptr, {&image}}.find("front")), nullptr);
}

}  // namespace
}  // namespace cdiff::planning
