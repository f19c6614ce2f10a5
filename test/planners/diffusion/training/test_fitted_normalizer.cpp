// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "learning/small_samples.h"
#include "planners/diffusion/training/prepared_data.h"

namespace cdiff::planners {
namespace {

TEST(FittedNormalizer, OfKnownSamples) {
  // Samples 0 and 1 drive 5 and 6 m/s: mean 5.5, sd 0.5 of the speed; x after t + 1 rows is
  // v (t + 1) / 10, so mean 0.55 (t + 1), sd 0.05 (t + 1). y and heading are 0: least sd. Steer is
  // +-0.5: scale 2 x 0.5.
  const test::TemporaryFolder folder;
  test::writeShard(folder.path() / "a.shard", 2);
  const learning::Dataset stored(folder.path(), 0.0);
  const diffusion::Normalizer normalizer = fitNormalizer(learning::DrivingDataset(stored), true);
  for (int t = 0; t < 8; ++t) {
    EXPECT_NEAR(normalizer.mean(t, traffic::kRolloutX), 0.55 * (t + 1), 1e-6);
    EXPECT_NEAR(normalizer.scale(t, traffic::kRolloutX), 0.05 * (t + 1), 1e-6);
    EXPECT_NEAR(normalizer.mean(t, traffic::kRolloutSpeed), 5.5, 1e-6);
    EXPECT_NEAR(normalizer.scale(t, traffic::kRolloutSpeed), 0.5, 1e-6);
    EXPECT_EQ(normalizer.scale(t, traffic::kRolloutY), 0.05);
    EXPECT_EQ(normalizer.scale(t, traffic::kRolloutHeading), 0.01);
    EXPECT_EQ(normalizer.mean(t, traffic::kRolloutThrottle), 0.5);
    EXPECT_EQ(normalizer.scale(t, traffic::kRolloutBrake), 0.5);
    EXPECT_EQ(normalizer.mean(t, traffic::kRolloutSteer), 0.0);
    EXPECT_NEAR(normalizer.scale(t, traffic::kRolloutSteer), 1.0, 1e-6);
  }
}

}  // namespace
}  // namespace cdiff::planners
