// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "realism/recording.h"

namespace cdiff::realism {
namespace {

using core::degreesToRadians;

geometry::OrientedBox boxAt(double x, double y, double degrees = 0.0) {
  return {{x, y}, degreesToRadians(degrees), 4.0, 2.0};
}

TEST(SignedDistance, IsTheGapOrMinusTheWayOut) {
  // 4 m x 2 m boxes: centers 5 m apart along both lengths leave 1 m.
  EXPECT_NEAR(signedDistance(boxAt(0, 0), boxAt(5, 0)), 1.0, 1e-9);
  // 3 m apart: 1 m to get out lengthwise, 2 m sideways.
  EXPECT_NEAR(signedDistance(boxAt(0, 0), boxAt(3, 0)), -1.0, 1e-9);
  // 1.5 m lengthwise and 1.5 m sideways: 2.5 m and .5 m.
  EXPECT_NEAR(signedDistance(boxAt(0, 0), boxAt(1.5, 1.5)), -0.5, 1e-9);
  // Across at 2.5 m: half length 2 and half width 1 reach 3 m: .5 m to get out.
  EXPECT_NEAR(signedDistance(boxAt(0, 0), boxAt(2.5, 0, 90)), -0.5, 1e-9);
  // Corner to corner: gaps of 3 m and 4 m.
  EXPECT_NEAR(signedDistance(boxAt(0, 0), boxAt(7, 6)), 5.0, 1e-9);
}

TEST(TimeToCollision, IsTheGapOverTheClosingSpeed) {
  // 14 m between centers, half lengths of 2 m each: gap 10 m, closing at 10 - 5 m/s: 2 s.
  const MovingBox self{boxAt(0, 0), 10.0};
  EXPECT_NEAR(timeToCollision(self, {{boxAt(14, 0), 5.0}}), 2.0, 1e-9);
  // The nearest ahead decides, even where the one beyond it would be met sooner.
  EXPECT_NEAR(timeToCollision(self, {{boxAt(34, 0), 0.0}, {boxAt(14, 0), 8.0}}), 5.0, 1e-9);
  EXPECT_NEAR(timeToCollision(self, {{boxAt(14, 0), 7.5}}), 4.0, 1e-9);
  EXPECT_EQ(timeToCollision(self, {{boxAt(14, 0), 10.0}}), 5.0);   // not closing
  EXPECT_EQ(timeToCollision(self, {{boxAt(-14, 0), 0.0}}), 5.0);   // behind
  EXPECT_EQ(timeToCollision(self, {{boxAt(14, 2.1), 0.0}}), 5.0);  // beside the way
  EXPECT_EQ(timeToCollision(self, {}), 5.0);
}

TEST(TimeToCollision, AsksForLikeHeadings) {
  const MovingBox self{boxAt(0, 0), 10.0};
  // At 70 degrees the other reaches back by 2 cos 70 + sin 70 = 1.6237: gap 14 - 2 - 1.6237.
  const double gap = 12.0 - 2.0 * std::cos(degreesToRadians(70)) - std::sin(degreesToRadians(70));
  EXPECT_NEAR(timeToCollision(self, {{boxAt(14, 0, 70), 0.0}}), gap / 10.0, 1e-9);
  EXPECT_EQ(timeToCollision(self, {{boxAt(14, 0, 80), 0.0}}), 5.0);
  // 1.6 m beside: widths overlap by .4 m (less than .5): parallel counts, 20 degrees does not
  // where the overlap stays small: at 20 degrees the other reaches 2 sin 20 + cos 20 = 1.6237
  // sideways, so that 2.3 m beside leaves .3237 m.
  EXPECT_LT(timeToCollision(self, {{boxAt(14, 1.6), 0.0}}), 5.0);
  EXPECT_EQ(timeToCollision(self, {{boxAt(14, 2.3, 20), 0.0}}), 5.0);
  EXPECT_LT(timeToCollision(self, {{boxAt(14, 2.0, 20), 0.0}}), 5.0);  // .6237 m
}

/// Two vehicles in one lane: one at 10 m/s behind one that stands 30 m ahead.
Recording following() {
  Recording recording;
  recording.tracks.resize(2);
  for (int i = 0; i < 12; ++i) {
    recording.tracks[0].states.push_back({{1.0 * i, 0.0}, 0.0, 0.0});
    recording.tracks[1].states.push_back({{30.0, 0.0}, 0.0, 0.0});
  }
  recording.tracks[0].id = "moving";
  recording.tracks[1].id = "standing";
  return recording;
}

TEST(Course, HoldsTheFeaturesStepByStep) {
  const Recording recording = following();
  const std::vector<Motion> motions = {centralMotion(recording.tracks[0]),
                                       centralMotion(recording.tracks[1])};
  const Course course = courseOf(recording, motions, 0, 5, 14);
  ASSERT_EQ(course[kLinearSpeed].size(), 9U);
  EXPECT_NEAR(course[kLinearSpeed][0], 10.0, 1e-9);
  // At step 5: 30 - 5 m between centers of vehicles of 4.5 m: 20.5 m, at 10 m/s 2.05 s.
  EXPECT_NEAR(course[kNearestObject][0], 20.5, 1e-9);
  EXPECT_NEAR(course[kTimeToCollision][0], 2.05, 1e-9);
  EXPECT_EQ(course[kCollision][0], 0.0);
  EXPECT_TRUE(std::isnan(course[kNearestObject][7]));  // step 12: gone
  EXPECT_TRUE(std::isnan(course[kCollision][8]));
}

TEST(Course, PassesOverOtherLevels) {
  Recording recording = following();
  for (TrackState& state : recording.tracks[1].states) state.elevation = 6.0;  // a bridge
  const std::vector<Motion> motions = {centralMotion(recording.tracks[0]),
                                       centralMotion(recording.tracks[1])};
  const Course course = courseOf(recording, motions, 0, 5, 6);
  EXPECT_EQ(course[kNearestObject][0], kNobody);
  EXPECT_EQ(course[kTimeToCollision][0], 5.0);
}

}  // namespace
}  // namespace cdiff::realism
