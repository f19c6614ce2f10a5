// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "e2e_cdiff/core/random.h"

namespace cdiff::core {
namespace {

TEST(Random, SameCoordinatesSameDraw) {
  const RandomStream first(7, "traffic");
  const RandomStream second(7, "traffic");
  const RandomKey key{hashText("bg_1"), 12, 3};
  EXPECT_EQ(first.bits(key, 5), second.bits(key, 5));
}

TEST(Random, EveryCoordinateMatters) {
  const RandomKey base{hashText("bg_1"), 12, 3};
  std::set<std::uint64_t> draws;
  draws.insert(RandomStream(7, "traffic").bits(base, 5));
  draws.insert(RandomStream(8, "traffic").bits(base, 5));
  draws.insert(RandomStream(7, "noise").bits(base, 5));
  draws.insert(RandomStream(7, "traffic").bits(base, 6));
  draws.insert(RandomStream(7, "traffic").bits({hashText("bg_2"), 12, 3}, 5));
  draws.insert(RandomStream(7, "traffic").bits({hashText("bg_1"), 13, 3}, 5));
  draws.insert(RandomStream(7, "traffic").bits({hashText("bg_1"), 12, 4}, 5));
  EXPECT_EQ(draws.size(), 7u);
}

// Mean of n uniforms has standard deviation 1 / sqrt(12 n): 0.00091 for n = 100,000; five of them
// are 0.0046.
TEST(Random, UniformMomentsAndRange) {
  const RandomStream stream(1, "test");
  double sum = 0.0;
  for (std::uint32_t i = 0; i < 100000; ++i) {
    const double value = stream.uniform({}, i);
    ASSERT_GE(value, 0.0);
    ASSERT_LT(value, 1.0);
    sum += value;
  }
  EXPECT_NEAR(sum / 100000.0, 0.5, 0.0046);
}

// Standard errors for n = 100,000: mean 0.0032, variance sqrt(2 / n) = 0.0045, fourth moment
// sqrt(96 / n) = 0.031.
TEST(Random, NormalMoments) {
  const RandomStream stream(1, "test");
  double sum = 0.0, squares = 0.0, fourth = 0.0;
  for (std::uint32_t i = 0; i < 100000; ++i) {
    const double value = stream.normal({}, i);
    sum += value;
    squares += value * value;
    fourth += std::pow(value, 4);
  }
  EXPECT_NEAR(sum / 100000.0, 0.0, 0.016);
  EXPECT_NEAR(squares / 100000.0, 1.0, 0.023);
  EXPECT_NEAR(fourth / 100000.0, 3.0, 0.155);
}

TEST(Random, IndexCoversAll) {
  const RandomStream stream(1, "test");
  std::set<std::size_t> seen;
  for (std::uint32_t i = 0; i < 200; ++i) seen.insert(stream.index({}, i, 5));
  EXPECT_EQ(seen, (std::set<std::size_t>{0, 1, 2, 3, 4}));
}

}  // namespace
}  // namespace cdiff::core
