// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "learning/samples/sample_order.h"

namespace cdiff::learning {
namespace {

TEST(SampleOrder, AnEpochHoldsEachSampleAsOftenAsItsWeight) {
  const core::RandomStream random(1, "order");
  std::vector<double> weights(100, 0.5);
  std::fill(weights.begin() + 75, weights.end(), 2.5);
  std::map<std::size_t, int> times;
  const std::vector<std::size_t> epoch = drawEpoch(weights, random, 0);
  ASSERT_EQ(epoch.size(), 100U);
  for (const std::size_t index : epoch) ++times[index];
  for (std::size_t i = 0; i < 75; ++i) EXPECT_LE(times[i], 1);
  for (std::size_t i = 75; i < 100; ++i) EXPECT_TRUE(times[i] == 2 || times[i] == 3);
  EXPECT_EQ(epoch, drawEpoch(weights, random, 0));
  EXPECT_NE(epoch, drawEpoch(weights, random, 1));
  EXPECT_FALSE(std::is_sorted(epoch.begin(), epoch.end()));
}

TEST(SampleOrder, EqualWeightsGiveEverySampleOnce) {
  const core::RandomStream random(1, "order");
  std::vector<std::size_t> epoch = drawEpoch(std::vector<double>(1000, 1.0), random, 3);
  std::sort(epoch.begin(), epoch.end());
  for (std::size_t i = 0; i < epoch.size(); ++i) EXPECT_EQ(epoch[i], i);
}

TEST(SampleOrder, AStepIsTheSameWhateverCameBefore) {
  const core::RandomStream random(1, "order");
  const std::vector<std::size_t> samples = {3, 5, 8, 13, 21};
  const auto order = [&] { return SampleOrder(samples, std::vector<double>(5, 1.0), 2, random); };
  SampleOrder from_start = order();
  std::map<std::size_t, int> times;
  for (std::int64_t step = 0; step < 5; ++step) {
    EXPECT_EQ(from_start.at(step), order().at(step)) << step;
    for (const std::size_t sample : order().at(step)) ++times[sample];
  }
  // Five steps of two are two epochs: each of the five samples comes twice.
  ASSERT_EQ(times.size(), 5U);
  for (const auto& [sample, count] : times) EXPECT_EQ(count, 2) << sample;
  EXPECT_EQ(times.begin()->first, 3U);
}

}  // namespace
}  // namespace cdiff::learning
