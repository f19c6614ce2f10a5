// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/core/angle.h"
#include "planners/camera_ego/bev_memory.h"

namespace cdiff::planners {
namespace {

traffic::VehicleState at(double x, double heading) {
  traffic::VehicleState state;
  state.position = {x, 0.0};
  state.heading = heading;
  state.speed = 6.0;
  return state;
}

/// A BEV of 3 cells with 2 channels that begins with `first`.
inference::Rows bevOf(float first) {
  inference::Rows bev;
  bev.resize(3, 2);
  for (std::int64_t row = 0; row < 3; ++row) {
    bev.row(row)[0] = first + static_cast<float>(row);
    bev.row(row)[1] = -first;
  }
  return bev;
}

// Half a second is five decisions of 0.1 s.
TEST(BevMemory, GivesWhatWasKeptHalfASecondAgo) {
  BevMemory memory(0.1);
  for (int i = 0; i < 9; ++i) {
    const EgoPoses poses = memory.posesAt(at(i, 0.0));
    EXPECT_EQ(poses.present.position.x(), i);
    ASSERT_EQ(poses.past.has_value(), i >= 5) << i;
    ASSERT_EQ(memory.past() != nullptr, i >= 5) << i;
    if (i >= 5) {
      EXPECT_EQ(poses.past->position.x(), i - 5);
      for (std::int64_t row = 0; row < 3; ++row) {
        EXPECT_EQ(memory.past()->row(row)[0], static_cast<float>(10 * (i - 5) + row));
        EXPECT_EQ(memory.past()->row(row)[1], static_cast<float>(-10 * (i - 5)));
      }
    }
    memory.keep(at(i, 0.0), bevOf(10.0F * static_cast<float>(i)), 2);
  }
  memory.forget();
  EXPECT_EQ(memory.past(), nullptr);
  EXPECT_FALSE(memory.posesAt(at(9.0, 0.0)).past.has_value());
}

// The past ego looks along y: (-1, 3) of the map are 3 m ahead of it and 1 m to the left.
TEST(EgoMotion, IsTheWaySeenFromThePast) {
  const EgoPoses poses{{{0.0, 5.0}, 0.5 * core::kPi + 0.2},
                       geometry::Pose2d{{1.0, 2.0}, 0.5 * core::kPi}};
  const double numbers[] = {6.0, -0.5, 3.0, 1.0, 0.2};
  const EgoMotion motion = egoMotion(6.0, -0.5, poses);
  const EgoMotion first = egoMotion(6.0, -0.5, {poses.present, std::nullopt});
  ASSERT_EQ(motion.size(), 5U);
  for (std::size_t i = 0; i < motion.size(); ++i) {
    EXPECT_NEAR(motion[i] * kEgoMotionUnits[i], numbers[i], 1e-5) << i;
    EXPECT_NEAR(first[i] * kEgoMotionUnits[i], i < 2 ? numbers[i] : 0.0, 1e-5) << i;
  }
}

// From 3.1 to -3.1 the heading turned by 2 pi - 6.2 = 0.0832 in one decision of 0.1 s; before the
// first it had not turned.
TEST(BevMemory, TheYawRateIsTheTurnSinceTheLastDecision) {
  BevMemory memory(0.1);
  const auto expectRate = [&](const traffic::VehicleState& now, double rate) {
    const EgoPoses poses = memory.posesAt(now);
    const EgoMotion found = memory.motionAt(now, poses), wanted = egoMotion(6.0, rate, poses);
    for (std::size_t i = 0; i < wanted.size(); ++i) EXPECT_NEAR(found[i], wanted[i], 1e-5) << i;
  };
  expectRate(at(0.0, 3.1), 0.0);
  memory.keep(at(0.0, 3.1), bevOf(0.0F), 2);
  expectRate(at(0.6, -3.1), (2.0 * core::kPi - 6.2) / 0.1);
  expectRate(at(0.6, 3.0), -1.0);
}

}  // namespace
}  // namespace cdiff::planners
