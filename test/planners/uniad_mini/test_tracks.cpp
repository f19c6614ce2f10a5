// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "planners/uniad_mini/track_set.h"
#include "planners/uniad_mini/uniad_mini_weights.h"

namespace cdiff::planners {
namespace {

/// x from -16 to 48 m, y from -32 to 32 m.
BevGrid uniadBev() { return UniadMiniArchitecture{}.ego.bev; }

TrackSet oneTrack(const Eigen::Vector2d& center, const Eigen::Vector2d& velocity) {
  TrackSet tracks;
  tracks.live = {true};
  tracks.centers = {center};
  tracks.velocities = {velocity};
  return tracks;
}

TEST(Tracks, AreBornAtOneScoreAndLiveOnAtALowerOne) {
  EXPECT_TRUE(holdsTrack(false, 0.4));
  EXPECT_FALSE(holdsTrack(false, 0.39));
  EXPECT_TRUE(holdsTrack(true, 0.36));
  EXPECT_FALSE(holdsTrack(true, 0.34));
}

// 10 m ahead and 2 m to the left at 4 m/s: 12 m ahead half a second later, seen from where the ego
// was. Now it stands at (3, 1) and looks to the left: 1 m of the 2 m are ahead of it, and the 9 m
// to the right.
TEST(Tracks, MoveByTheirVelocityAndTheWayOfTheEgo) {
  const TrackSet tracks = oneTrack({10.0, 2.0}, {4.0, 0.0});
  const EgoPoses poses{{{3.0, 1.0}, M_PI / 2.0}, geometry::Pose2d{{0.0, 0.0}, 0.0}};
  const auto moved = movedCenter(tracks, 0, poses, uniadBev());
  ASSERT_TRUE(moved.has_value());
  EXPECT_NEAR(moved->x(), 1.0, 1e-9);
  EXPECT_NEAR(moved->y(), -9.0, 1e-9);
}

TEST(Tracks, EndWhereTheBevEndsAndWithoutAPast) {
  const EgoPoses poses{{{0.0, 0.0}, 0.0}, geometry::Pose2d{{0.0, 0.0}, 0.0}};
  EXPECT_TRUE(movedCenter(oneTrack({47.0, 0.0}, {1.0, 0.0}), 0, poses, uniadBev()).has_value());
  EXPECT_FALSE(movedCenter(oneTrack({47.0, 0.0}, {3.0, 0.0}), 0, poses, uniadBev()).has_value());
  const double none = std::nan("");
  EXPECT_FALSE(movedCenter(oneTrack({none, 0.0}, {0.0, 0.0}), 0, poses, uniadBev()).has_value());
  const EgoPoses first{{{0.0, 0.0}, 0.0}, std::nullopt};
  EXPECT_FALSE(movedCenter(oneTrack({5.0, 0.0}, {0.0, 0.0}), 0, first, uniadBev()).has_value());
  TrackSet dead = oneTrack({5.0, 0.0}, {0.0, 0.0});
  dead.live = {false};
  EXPECT_FALSE(movedCenter(dead, 0, poses, uniadBev()).has_value());
}

// 32 m ahead are three quarters of the way from -16 to 48 m: log(0.75 / 0.25).
TEST(Tracks, ReferencesAreLogitsOfShares) {
  const auto reference = referenceAt(uniadBev(), {32.0, 0.0});
  EXPECT_NEAR(reference[0], 1.0986F, 1e-4F);
  EXPECT_NEAR(reference[1], 0.0F, 1e-6F);
  EXPECT_NEAR(referenceAt(uniadBev(), {48.0, 0.0})[0], 6.9068F, 1e-3F) << "never infinite";
}

TEST(Tracks, AreReadHalfASecondLater) {
  TrackMemory memory(0.1);
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(memory.past(), nullptr) << i;
    memory.keep(oneTrack({static_cast<double>(i), 0.0}, {0.0, 0.0}));
  }
  ASSERT_NE(memory.past(), nullptr);
  EXPECT_EQ(memory.past()->centers[0].x(), 0.0);
  memory.keep(oneTrack({5.0, 0.0}, {0.0, 0.0}));
  EXPECT_EQ(memory.past()->centers[0].x(), 1.0);
  memory.forget();
  EXPECT_EQ(memory.past(), nullptr);
}

}  // namespace
}  // namespace cdiff::planners
