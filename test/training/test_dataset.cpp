// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "e2e_cdiff/core/exceptions.h"
#include "training/dataset.h"
#include "training/small_samples.h"

namespace cdiff::training {
namespace {

using core::InputError;

TEST(Dataset, HoldsOutWholeSessions) {
  const test::TemporaryFolder folder;
  for (int shard = 0; shard < 2; ++shard) {
    ShardWriter writer(test::smallSchema());
    for (std::size_t i = 0; i < 60; ++i) writer.append(test::smallSample(i % 8, i / 2));
    writer.write(folder.path() / (std::to_string(shard) + ".shard"));
  }
  const Dataset dataset(folder.path(), 0.3);
  EXPECT_EQ(dataset.size(), 120U);
  EXPECT_EQ(dataset.sessions(), 30U);
  EXPECT_EQ(dataset.training().size() + dataset.validation().size(), 120U);
  std::set<std::uint64_t> held_out;
  for (const std::size_t i : dataset.validation()) held_out.insert(dataset.sample(i).session);
  EXPECT_EQ(held_out.size(), dataset.validationSessions());
  for (const std::size_t i : dataset.training())
    EXPECT_EQ(held_out.count(dataset.sample(i).session), 0U);
}

TEST(Dataset, OfTwoSessionsOneIsHeldOutWhateverTheShare) {
  const test::TemporaryFolder folder;
  ShardWriter writer(test::smallSchema());
  for (std::size_t i = 0; i < 6; ++i) writer.append(test::smallSample(i, i / 3));
  writer.write(folder.path() / "a.shard");
  for (const double share : {1e-9, 0.1, 0.9}) {
    const Dataset dataset(folder.path(), share);
    EXPECT_EQ(dataset.validationSessions(), 1U) << share;
    EXPECT_EQ(dataset.validation().size(), 3U) << share;
    EXPECT_EQ(dataset.training().size(), 3U) << share;
  }
}

TEST(Dataset, RefusesASplitWithoutBothPartsAndForeignSchemas) {
  const test::TemporaryFolder folder;
  test::writeShard(folder.path() / "a.shard", 4);
  EXPECT_THROW(Dataset(folder.path(), 1e-9), InputError);
  EXPECT_EQ(Dataset(folder.path(), 0.0).validation().size(), 4U);
  SampleSchema other = test::smallSchema();
  other.route_spacing = 2.0;
  ShardWriter writer(other);
  writer.append(test::smallSample(0, 1));
  writer.write(folder.path() / "b.shard");
  EXPECT_THROW(Dataset(folder.path(), 0.0), InputError);
}

TEST(Dataset, NormaliserOfKnownSamples) {
  // Samples 0 and 1 drive 5 and 6 m/s: mean 5.5, sd 0.5 of the speed; x after t + 1 rows is
  // v (t + 1) / 10, so mean 0.55 (t + 1), sd 0.05 (t + 1). y and heading are 0: least sd. Steer is
  // +-0.5: scale 2 x 0.5.
  const test::TemporaryFolder folder;
  test::writeShard(folder.path() / "a.shard", 2);
  const diffusion::Normalizer normalizer = fitNormalizer(Dataset(folder.path(), 0.0), true);
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

TEST(Mirror, ExchangesLeftAndRightAndIsItsOwnInverse) {
  SampleSchema schema = test::smallSchema();
  schema.auxiliary = {"gap", "offset_left"};
  Sample sample = test::smallSample(0, 1);
  sample.auxiliary = {2.0F, 3.0F};
  sample.rollout.col(traffic::kRolloutY).setConstant(1.5);
  sample.rollout.col(traffic::kRolloutHeading).setConstant(0.25);
  const Sample before = sample;
  mirrorSample(schema, sample);
  EXPECT_EQ(sample.auxiliary, (std::vector<float>{2.0F, -3.0F}));
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

TEST(Dataset, ShardsWithoutSamplesAreNamed) {
  const test::TemporaryFolder folder;
  test::writeShard(folder.path() / "a.shard", 0);
  try {
    const Dataset dataset(folder.path(), 0.0);
    FAIL() << "read";
  } catch (const core::InputError& error) {
    EXPECT_EQ(std::string(error.what())
                  .rfind("data folder '" + folder.path().string() +
                             "': its shards hold no samples; collect",
                         0),
              0U)
        << error.what();
  }
}

}  // namespace
}  // namespace cdiff::training
