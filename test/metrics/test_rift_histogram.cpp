// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "e2e_cdiff/core/exceptions.h"
#include "metrics/formulas/distributions.h"
#include "metrics/formulas/rift_histogram.h"

namespace cdiff::metrics {
namespace {

RiftHistogram filled(RiftHistogram histogram, const std::vector<std::uint64_t>& counts) {
  for (std::size_t i = 0; i < counts.size(); ++i) {
    histogram.add(0.5 * (histogram.edges()[i] + histogram.edges()[i + 1]), counts[i]);
  }
  return histogram;
}

TEST(RiftHistogram, HasBinsClosedOnTheRight) {
  RiftHistogram histogram({0.0, 1.0, 2.0});
  histogram.add(0.0);   // the first edge belongs to the first bin
  histogram.add(1.0);   // first bin
  histogram.add(1.01);  // second bin
  histogram.add(2.0);   // dropped: not below the last edge
  histogram.add(-0.1);  // dropped
  histogram.add(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(histogram.counts(), (std::vector<std::uint64_t>{2, 1}));
}

TEST(RiftHistogram, TakesMeanAndVarianceFromMidpoints) {
  RiftHistogram histogram({0.0, 1.0, 2.0});
  EXPECT_FALSE(histogram.mean().has_value());
  EXPECT_FALSE(histogram.variance().has_value());
  histogram.add(0.9, 3);
  histogram.add(1.1);  // (3 x 0.5 + 1.5) / 4 = 0.75; (3 x 0.25 + 2.25) / 4 - 0.5625 = 0.1875
  EXPECT_DOUBLE_EQ(*histogram.mean(), 0.75);
  EXPECT_DOUBLE_EQ(*histogram.variance(), 0.1875);
}

TEST(RiftHistogram, RefusesBadEdges) {
  EXPECT_THROW(RiftHistogram({}), core::InputError);
  EXPECT_THROW(RiftHistogram({1.0}), core::InputError);
  EXPECT_THROW(RiftHistogram({1.0, 0.0}), core::InputError);
  RiftHistogram histogram({0.0, 1.0});
  EXPECT_THROW(histogram.add(RiftHistogram({0.0, 2.0})), core::InputError);
}

TEST(RiftHistogram, DrawsNumpysStream) {
  // One bin from 0 to 1: three numbers choose the bin, the next three of the stream are the values.
  RiftHistogram histogram({0.0, 1.0});
  histogram.add(0.5);
  const auto values = histogram.resample(3);
  EXPECT_DOUBLE_EQ(values[0], 0.5448831829968969);
  EXPECT_DOUBLE_EQ(values[1], 0.4236547993389047);
  EXPECT_DOUBLE_EQ(values[2], 0.6458941130666561);
  // Two equal bins: 0.5488, 0.7152 and 0.6028 are all above a half, so all values lie in the
  // second.
  RiftHistogram two({0.0, 1.0, 2.0});
  two.add(0.5);
  two.add(1.5);
  EXPECT_DOUBLE_EQ(two.resample(3)[0], 1.5448831829968969);
}

TEST(RiftHistogram, DrawsZerosWhenEmpty) {
  EXPECT_EQ(riftSpeedHistogram().resample(2), (std::vector<double>{0.0, 0.0}));
}

TEST(RiftHistogram, GivesThePublishedSpeedValues) {
  const auto histogram =
      filled(riftSpeedHistogram(), {10, 20, 30, 40, 50, 60, 120, 160, 120, 60, 20, 10});
  const double deviation = std::sqrt(*histogram.variance());
  EXPECT_NEAR(*histogram.mean(), 4.789, 5e-4);
  EXPECT_NEAR(deviation, 2.713, 5e-4);
  EXPECT_NEAR(riftSpeedWasserstein(*histogram.mean(), deviation), 4.5967, 5e-5);
  EXPECT_NEAR(*shapiroWilk(histogram.resample(3000)).w, 0.956949, 1e-6);
}

TEST(RiftHistogram, GivesThePublishedAccelerationValue) {
  const auto histogram =
      filled(riftAccelerationHistogram(), {0, 0, 0, 0, 50, 80, 90, 70, 50, 40, 60, 40, 20});
  EXPECT_NEAR(*shapiroWilk(histogram.resample(3000)).w, 0.931462, 1e-6);
}

TEST(RiftHistogram, CallsASingleBinNearlyNormal) {
  RiftHistogram histogram = riftSpeedHistogram();
  histogram.add(7.0, 100);
  EXPECT_NEAR(*shapiroWilk(histogram.resample(3000)).w, 0.956, 1e-3);
}

}  // namespace
}  // namespace cdiff::metrics
