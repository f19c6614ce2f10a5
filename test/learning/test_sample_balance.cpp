// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <numeric>

#include "e2e_cdiff/core/exceptions.h"
#include "learning/samples/sample_order.h"
#include "learning/small_samples.h"

namespace cdiff::learning {
namespace {

DrivingSample drivingAt(double first, double last, std::uint8_t maneuver) {
  DrivingSample sample = test::smallSample(0, 1);
  sample.speed = first;
  sample.maneuver = maneuver;
  const Eigen::Index rows = sample.rollout.rows();
  for (Eigen::Index t = 0; t < rows; ++t) {
    const double share = static_cast<double>(t + 1) / static_cast<double>(rows);
    sample.rollout(t, traffic::kRolloutSpeed) = first + share * (last - first);
  }
  return sample;
}

/// 80 samples straight on at 10 m/s, 20 that start into a left turn.
void writeUneven(const std::filesystem::path& file) {
  DrivingShardWriter writer(test::smallSchema());
  for (std::size_t i = 0; i < 100; ++i) {
    DrivingSample sample = i < 80 ? drivingAt(10.0, 10.0, 0) : drivingAt(0.0, 3.0, 1);
    sample.session = i;
    writer.append(sample);
  }
  writer.write(file);
}

TEST(SampleBalance, ClassesAreManeuverAndPace) {
  EXPECT_EQ(balanceClass(drivingAt(0.0, 0.0, 3)), "other standing");
  EXPECT_EQ(balanceClass(drivingAt(0.0, 3.0, 1)), "left starting");
  EXPECT_EQ(balanceClass(drivingAt(5.0, 0.0, 0)), "straight stopping");
  EXPECT_EQ(balanceClass(drivingAt(3.0, 3.0, 2)), "right slow");
  EXPECT_EQ(balanceClass(drivingAt(6.0, 6.0, 2)), "right middle");
  EXPECT_EQ(balanceClass(drivingAt(9.0, 9.0, 0)), "straight fast");
}

TEST(SampleBalance, WeightsRaiseRareClassesByThePowerAsked) {
  const test::TemporaryFolder folder;
  writeUneven(folder.path() / "a.shard");
  const Dataset stored(folder.path(), 0.0);
  const DrivingDataset dataset(stored);
  for (const double weight : balanceWeights(dataset, 0.0)) EXPECT_DOUBLE_EQ(weight, 1.0);
  const std::vector<double> even = balanceWeights(dataset, 1.0);
  EXPECT_NEAR(std::accumulate(even.begin(), even.begin() + 80, 0.0), 50.0, 1e-9);
  EXPECT_NEAR(std::accumulate(even.begin() + 80, even.end(), 0.0), 50.0, 1e-9);
  const std::vector<double> half = balanceWeights(dataset, 0.5);
  EXPECT_NEAR(half[80] / half[0], 2.0, 1e-9);
}

/// 60 samples straight on at 10 m/s, 20 that stop to give way, 20 that stop for another reason.
void writeYielding(const std::filesystem::path& file) {
  DrivingShardWriter writer(test::smallSchema());
  for (std::size_t i = 0; i < 100; ++i) {
    DrivingSample sample = drivingAt(10.0, i < 60 ? 10.0 : 0.0, 0);
    sample.session = i;
    if (i >= 80) sample.stop_reason = kStopYielding;
    writer.append(sample);
  }
  writer.write(file);
}

TEST(SampleBalance, ThoseThatGiveWayComeByTheirShare) {
  const test::TemporaryFolder folder;
  writeYielding(folder.path() / "a.shard");
  const Dataset stored(folder.path(), 0.0);
  const DrivingDataset dataset(stored);
  const std::vector<double> quarter = balanceWeights(dataset, 0.5, 0.25);
  EXPECT_NEAR(quarter[99] / quarter[79], 0.25, 1e-9);
  EXPECT_NEAR(std::accumulate(quarter.begin(), quarter.end(), 0.0), 100.0, 1e-9);
  // Those left out do not count for their class either: its rest comes as often as the others.
  const std::vector<double> none = balanceWeights(dataset, 1.0, 0.0);
  EXPECT_EQ(none[99], 0.0);
  EXPECT_NEAR(std::accumulate(none.begin(), none.begin() + 60, 0.0), 50.0, 1e-9);
  EXPECT_NEAR(std::accumulate(none.begin() + 60, none.end(), 0.0), 50.0, 1e-9);
}

TEST(SampleBalance, NothingLeftIsSaid) {
  const test::TemporaryFolder folder;
  DrivingShardWriter writer(test::smallSchema());
  DrivingSample sample = drivingAt(10.0, 0.0, 0);
  sample.stop_reason = kStopYielding;
  writer.append(sample);
  writer.write(folder.path() / "a.shard");
  const Dataset stored(folder.path(), 0.0);
  EXPECT_THROW(balanceWeights(DrivingDataset(stored), 0.5, 0.0), core::InputError);
}

}  // namespace
}  // namespace cdiff::learning
