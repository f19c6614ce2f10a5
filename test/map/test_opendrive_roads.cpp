// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/core/angle.h"
#include "map/opendrive_roads.h"
#include "support/error_text.h"

namespace cdiff::map {
namespace {

/// A road with one lane on each side, 3 m wide, raised by 2 m.
std::string road(const std::string& length, const std::string& geometry) {
  const std::string width = R"(<width sOffset="0" a="3" b="0" c="0" d="0"/></lane>)";
  return R"(<OpenDRIVE><road id="r" length=")" + length +
         R"("><planView><geometry s="0" x="10" y="20" hdg="0" length=")" + length + "\">" +
         geometry +
         R"(</geometry></planView><elevationProfile><elevation s="0" a="2" b="0" c="0" d="0"/></elevationProfile>
<lanes><laneSection s="0"><left><lane id="1" type="driving">)" +
         width + R"(</left><right><lane id="-1" type="driving">)" + width +
         "</right></laneSection></lanes></road></OpenDRIVE>";
}

TEST(OpenDriveRoads, ALineAndItsLanes) {
  const OpenDriveRoads roads(road("100", "<line/>"), "net");
  const double center = roads.laneCenter("r", -1, 40.0);
  EXPECT_NEAR(center, -1.5, 1e-12);
  EXPECT_NEAR(roads.laneCenter("r", 1, 40.0), 1.5, 1e-12);
  const geometry::Pose2d pose = roads.poseAt("r", 40.0, center);
  EXPECT_NEAR(pose.position.x(), 50.0, 1e-9);
  EXPECT_NEAR(pose.position.y(), 18.5, 1e-9);
  EXPECT_EQ(roads.elevationAt("r", 40.0), 2.0);
}

TEST(OpenDriveRoads, AQuarterOfACircle) {
  // Radius 20 m: from (10, 20) to (30, 40), turned by 90 degrees.
  const double length = 10.0 * core::kPi;
  const OpenDriveRoads roads(road(std::to_string(length), R"(<arc curvature="0.05"/>)"), "net");
  const geometry::Pose2d pose = roads.poseAt("r", length, 0.0);
  EXPECT_NEAR(pose.position.x(), 30.0, 1e-3);
  EXPECT_NEAR(pose.position.y(), 40.0, 1e-3);
  EXPECT_NEAR(pose.heading, 0.5 * core::kPi, 1e-6);
}

TEST(OpenDriveRoads, ASpiralTurnsByHalfItsCurvatureTimesItsLength) {
  const OpenDriveRoads roads(road("40", R"(<spiral curvStart="0" curvEnd="0.05"/>)"), "net");
  EXPECT_NEAR(roads.poseAt("r", 40.0, 0.0).heading, 1.0, 1e-9);
}

TEST(OpenDriveRoads, APolynomialOfItsShareOfTheLength) {
  // u = 30 p, v = 10 p^2 at p = 1: (40, 30), with slope 20 / 30.
  const OpenDriveRoads roads(
      road(
          "32",
          R"(<paramPoly3 pRange="normalized" aU="0" bU="30" cU="0" dU="0" aV="0" bV="0" cV="10" dV="0"/>)"),
      "net");
  const geometry::Pose2d pose = roads.poseAt("r", 32.0, 0.0);
  EXPECT_NEAR(pose.position.x(), 40.0, 1e-9);
  EXPECT_NEAR(pose.position.y(), 30.0, 1e-9);
  EXPECT_NEAR(pose.heading, std::atan2(20.0, 30.0), 1e-9);
}

TEST(OpenDriveRoads, LocatesTheLaneOfAPoint) {
  const OpenDriveRoads roads(road("100", "<line/>"), "net");
  const auto found = roads.locate({60.0, 21.0}, 2.0, core::kPi);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->lane, 1);
  EXPECT_NEAR(found->s, 50.0, 1e-6);
  EXPECT_NEAR(found->t, 1.0, 1e-9);
  EXPECT_FALSE(roads.locate({60.0, 24.0}, 2.0, 0.0));
}

TEST(OpenDriveRoads, WhatIsNotThereIsNamed) {
  const OpenDriveRoads roads(road("100", "<line/>"), "net");
  EXPECT_NE(
      test::errorOf([&] { roads.poseAt("x", 0.0, 0.0); }).find("no road 'x'; expected one of 'r'"),
      std::string::npos);
  EXPECT_NE(test::errorOf([&] { roads.poseAt("r", 101.0, 0.0); }).find("expected 0 to 100"),
            std::string::npos);
  EXPECT_NE(test::errorOf([&] { roads.laneCenter("r", -2, 0.0); }).find("no lane -2"),
            std::string::npos);
}

}  // namespace
}  // namespace cdiff::map
