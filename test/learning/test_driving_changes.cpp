// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "learning/samples/driving_sample.h"
#include "learning/small_samples.h"

namespace cdiff::learning {
namespace {

TEST(Mirror, ExchangesLeftAndRightAndIsItsOwnInverse) {
  DrivingSchema schema = test::smallSchema();
  schema.auxiliary = {"gap", "offset_left", "free_left_1", "free_right_1"};
  DrivingSample sample = test::smallSample(0, 1);
  sample.auxiliary = {2.0F, 3.0F, 4.0F, 5.0F};
  sample.rollout.col(traffic::kRolloutY).setConstant(1.5);
  sample.rollout.col(traffic::kRolloutHeading).setConstant(0.25);
  const DrivingSample before = sample;
  mirrorSample(schema, sample);
  EXPECT_EQ(sample.auxiliary, (std::vector<float>{2.0F, -3.0F, 5.0F, 4.0F}));
  EXPECT_EQ(sample.rollout(3, traffic::kRolloutY), -1.5);
  EXPECT_EQ(sample.rollout(3, traffic::kRolloutHeading), -0.25);
  EXPECT_EQ(sample.rollout(3, traffic::kRolloutSteer), -0.5);
  EXPECT_EQ(sample.rollout(3, traffic::kRolloutThrottle), 0.25);
  EXPECT_EQ(sample.route[1], -before.route[1]);
  EXPECT_EQ(sample.route[2], before.route[2]);
  // Pixel (row 5, column 2) comes from column 61.
  EXPECT_EQ(sample.image.rgb[(5 * 64 + 2) * 3 + 1], before.image.rgb[(5 * 64 + 61) * 3 + 1]);
  mirrorSample(schema, sample);
  EXPECT_EQ(sample.image.rgb, before.image.rgb);
  EXPECT_EQ(sample.rollout, before.rollout);
  EXPECT_EQ(sample.auxiliary, before.auxiliary);
}

TEST(Mirror, TurnsTheImageBeforeAsWell) {
  DrivingSample sample = test::motionSample(0, 1);
  const DrivingSample before = sample;
  mirrorSample(test::motionSchema(), sample);
  EXPECT_EQ(sample.previous_image.rgb[(5 * 64 + 2) * 3 + 1],
            before.previous_image.rgb[(5 * 64 + 61) * 3 + 1]);
  EXPECT_EQ(sample.target_speed, before.target_speed);
}

// The mean of an image shows brightness and contrast, its pixels also show the noise.
TEST(Light, TwoFramesOfASampleShareTheirLightAndNotTheirNoise) {
  const core::RandomStream random(3, "light");
  traffic::CameraImage frames[2];
  double means[2] = {0.0, 0.0};
  for (std::uint32_t i = 0; i < 2; ++i) {
    frames[i] = test::smallSample(0, 1).image;
    changeLight(random, {1, 5}, frames[i], i);
    for (const std::uint8_t value : frames[i].rgb) means[i] += value;
    means[i] /= static_cast<double>(frames[i].rgb.size());
  }
  EXPECT_NE(frames[0].rgb, frames[1].rgb);
  EXPECT_NEAR(means[0], means[1], 0.5);  // noise of at most 12 levels on 12,288 values
}

TEST(Light, ChangesTheImageTheSameWayForTheSameKey) {
  const core::RandomStream random(3, "light");
  traffic::CameraImage first = test::smallSample(0, 1).image;
  traffic::CameraImage second = first;
  traffic::CameraImage third = first;
  changeLight(random, {1, 5}, first);
  changeLight(random, {1, 5}, second);
  changeLight(random, {2, 5}, third);
  EXPECT_EQ(first.rgb, second.rgb);
  EXPECT_NE(first.rgb, third.rgb);
  EXPECT_NE(first.rgb, test::smallSample(0, 1).image.rgb);
}

}  // namespace
}  // namespace cdiff::learning
