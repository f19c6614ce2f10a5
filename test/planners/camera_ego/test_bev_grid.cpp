// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "planners/camera_ego/bev_memory.h"
#include "planners/camera_ego/camera_ego_sizes.h"

namespace cdiff::planners {
namespace {

// 40 x 20 cells of 1.5 m from 12 m behind: x from -12 to 48 m, y from -15 to 15 m.
TEST(BevGrid, CellsAndSharesAreWhereTheySay) {
  const BevGrid bev;
  EXPECT_EQ(bev.center(0), Eigen::Vector2d(-11.25, -14.25));
  EXPECT_EQ(bev.center(799), Eigen::Vector2d(47.25, 14.25));
  EXPECT_EQ(bev.toCell(bev.center(21)), Eigen::Vector2d(1.0, 1.0)) << "column, row";
  EXPECT_EQ(bev.toShare({48.0, 15.0}), Eigen::Vector2d(1.0, 1.0));
  EXPECT_TRUE(bev.fromShare(bev.toShare({3.0, -4.0})).isApprox(Eigen::Vector2d(3.0, -4.0)));
  EXPECT_TRUE(bev.contains({47.9, -14.9}));
  EXPECT_FALSE(bev.contains({48.1, 0.0}));
}

// The ego drove 3 m = 2 rows straight on: what lies in a row now lay 2 rows farther ahead.
TEST(BevGrid, ThePastLiesWhereTheEgoCameFrom) {
  const BevGrid bev;
  const auto plan = temporalPlan(bev, {{103.0, 50.0}, 0.0}, {{100.0, 50.0}, 0.0});
  ASSERT_EQ(plan.visits.size(), 1600U);
  const std::size_t visit = 2 * (5 * 20 + 7);
  const float* before = plan.references.data() + visit * 2 * kTemporalPoints;
  EXPECT_NEAR(before[0], 7.0F, 1e-4F);
  EXPECT_NEAR(before[1], 7.0F, 1e-4F);
  const float* now = before + 2 * kTemporalPoints;
  EXPECT_NEAR(now[0], 7.0F, 1e-4F);
  EXPECT_NEAR(now[1], 5.0F, 1e-4F);
  EXPECT_EQ(plan.shares[107], 0.5F);
}

TEST(BevGrid, CellsLookIntoTheCamerasThatSeeThem) {
  const CameraEgoSizes sizes;
  const auto plan = cameraPlan(sizes.bev, sizes.cameras(), 8);
  std::vector<int> seen(3), behind(1);
  for (const inference::MapVisit& visit : plan.visits) {
    const Eigen::Vector2d center = sizes.bev.center(visit.query);
    ++seen[static_cast<std::size_t>(visit.map)];
    if (center.x() < -3.0) ++behind[0];
    if (visit.map == 1) {
      EXPECT_GT(center.y(), -3.0) << "front_left looks left";
    }
    if (visit.map == 2) {
      EXPECT_LT(center.y(), 3.0) << "front_right looks right";
    }
  }
  EXPECT_EQ(behind[0], 0) << "nothing is seen behind";
  EXPECT_EQ(seen[1], seen[2]) << "the cameras are mirror images";
  EXPECT_GT(seen[0], 300);
}

// 9.2 m ahead of the front camera (0.8 m ahead of the center, 1.6 m high) on the road: 114.25 px of
// focal length x 1.6 / 9.2 = 19.87 px below the middle (47.5): row (47.5 + 19.87 + 0.5) / 8 - 0.5.
TEST(BevGrid, PillarsAreProjectedByThePinhole) {
  CameraEgoSizes sizes;
  sizes.bev = {4, 5, 1.0, -7.5};  // one cell is centered at (10, 0)
  const auto plan = cameraPlan(sizes.bev, sizes.cameras(), 8);
  for (std::size_t i = 0; i < plan.visits.size(); ++i) {
    if (plan.visits[i].map != 0 || plan.visits[i].query != 12) continue;
    EXPECT_EQ(sizes.bev.center(12), Eigen::Vector2d(10.0, 0.0));
    EXPECT_NEAR(plan.references[i * 2 * kCameraPoints], (79.5 + 0.5) / 8.0 - 0.5, 1e-4);
    EXPECT_NEAR(plan.references[i * 2 * kCameraPoints + 1], 7.9837, 2e-3);
    return;
  }
  FAIL() << "the cell is not seen";
}

TEST(BevMemory, GivesWhatIsHalfASecondOld) {
  BevMemory memory(0.1);
  inference::Rows bev;
  bev.resize(2, 16);
  traffic::VehicleState state;
  for (int i = 0; i < 7; ++i) {
    state.position.x() = i;
    if (i < 5) {
      EXPECT_EQ(memory.past(), nullptr) << i;
    } else {
      ASSERT_NE(memory.past(), nullptr);
      EXPECT_EQ(memory.past()->row(0)[0], static_cast<float>(i - 5));
      EXPECT_EQ(memory.posesAt(state).past->position.x(), i - 5.0);
      EXPECT_FLOAT_EQ(memory.motionAt(state, memory.posesAt(state))[2], 1.0F) << "5 m in 0.5 s";
    }
    bev.row(0)[0] = static_cast<float>(i);
    memory.keep(state, bev, 16);
  }
  memory.forget();
  EXPECT_EQ(memory.past(), nullptr);
}

}  // namespace
}  // namespace cdiff::planners
