// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "planners/uniad_mini/motion_anchors.h"

namespace cdiff::planners {
namespace {

/// Straight on at a constant speed, to `end` after 3 s.
TakenWay wayTo(double end, MotionGroup group) {
  TakenWay way{group, {}};
  for (std::size_t i = 0; i < way.places.size(); ++i)
    way.places[i] = {end * static_cast<double>(i + 1) / 6.0, 0.0};
  return way;
}

TEST(MotionAnchors, GroupsGoBySize) {
  EXPECT_EQ(motionGroupOf(4.6, 1.9), MotionGroup::kCar);
  EXPECT_EQ(motionGroupOf(12.0, 2.5), MotionGroup::kLarge);
  EXPECT_EQ(motionGroupOf(2.0, 0.8), MotionGroup::kNarrow);
}

// Pairs of ways end 0.5 m before and behind 5, 15 ... 55 m: their means are the clusters, whatever
// order they come in. Half of the way is half of the end.
TEST(MotionAnchors, AreTheMeansOfClusters) {
  std::vector<TakenWay> ways;
  for (const double end : {35.0, 5.0, 55.0, 25.0, 45.0, 15.0}) {
    ways.push_back(wayTo(end + 0.5, MotionGroup::kCar));
    ways.push_back(wayTo(end - 0.5, MotionGroup::kCar));
  }
  const auto anchors = clusterAnchors(ways);
  for (std::size_t mode = 0; mode < 6; ++mode) {
    const double end = 5.0 + 10.0 * static_cast<double>(mode);
    EXPECT_NEAR(anchors[0][mode].back().x(), end, 1e-9);
    EXPECT_NEAR(anchors[0][mode][2].x(), 0.5 * end, 1e-9);
    EXPECT_EQ(anchors[1][mode], anchors[0][mode]) << "no large vehicle: those of cars";
  }
}

// The two ways to the side end as far away as others; they get a cluster of their own.
TEST(MotionAnchors, TellTurnsFromWaysStraightOn) {
  std::vector<TakenWay> ways;
  for (const double end : {4.0, 8.0, 12.0, 16.0, 20.0}) {
    ways.push_back(wayTo(end, MotionGroup::kLarge));
    ways.push_back(wayTo(end, MotionGroup::kLarge));
  }
  for (int i = 0; i < 2; ++i) {
    ways.push_back(wayTo(10.0, MotionGroup::kLarge));
    for (Eigen::Vector2d& place : ways.back().places) place = {0.0, place.x()};
  }
  const auto anchors = clusterAnchors(ways);
  bool turns = false;
  for (const EgoWaypoints& way : anchors[1])
    turns = turns || (way.back() - Eigen::Vector2d(0.0, 10.0)).norm() < 1e-9;
  EXPECT_TRUE(turns);
}

// Without ways: straight on at 0, 3 ... 15 m/s.
TEST(MotionAnchors, StartSomewhereWithoutData) {
  const auto anchors = clusterAnchors({});
  EXPECT_EQ(anchors[2][2].back(), Eigen::Vector2d(18.0, 0.0));
  EXPECT_EQ(anchors[0][0].back(), Eigen::Vector2d(0.0, 0.0));
}

TEST(MotionAnchors, GoThroughTheWeightFile) {
  const auto anchors = clusterAnchors({});
  EXPECT_EQ(toTensor(anchors).shape, (std::vector<std::int64_t>{18, 12}));
  EXPECT_EQ(toAnchors(toTensor(anchors)), anchors);
}

}  // namespace
}  // namespace cdiff::planners
