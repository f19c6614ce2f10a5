// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "e2e_cdiff/core/random.h"
#include "planners/camera_ego/hungarian.h"

namespace cdiff::planners {
namespace {

double costOf(const std::vector<double>& cost, std::size_t columns, const std::vector<int>& match) {
  double sum = 0.0;
  for (std::size_t row = 0; row < match.size(); ++row)
    sum += cost[row * columns + static_cast<std::size_t>(match[row])];
  return sum;
}

/// The least cost of all permutations of the columns.
double leastCost(const std::vector<double>& cost, std::size_t rows, std::size_t columns) {
  std::vector<int> order(columns);
  std::iota(order.begin(), order.end(), 0);
  double least = 1e9;
  do {
    least = std::min(
        least,
        costOf(cost, columns, {order.begin(), order.begin() + static_cast<std::ptrdiff_t>(rows)}));
  } while (std::next_permutation(order.begin(), order.end()));
  return least;
}

// Row by row the cheapest column is 0 for both; together 1 + 2 beats 0 + 10.
TEST(Matching, IsCheapestTogether) {
  EXPECT_EQ(hungarian({0.0, 1.0, 2.0, 10.0}, 2, 2), (std::vector<int>{1, 0}));
}

TEST(Matching, IsAsCheapAsTheBestPermutation) {
  const core::RandomStream random(1, "costs");
  for (std::uint64_t trial = 0; trial < 40; ++trial) {
    const std::size_t rows = 1 + trial % 4, columns = rows + trial % 3;
    std::vector<double> cost;
    for (std::uint32_t i = 0; i < rows * columns; ++i)
      cost.push_back(random.uniform({trial}, i, -1.0, 3.0));
    const std::vector<int> match = hungarian(cost, rows, columns);
    std::vector<int> taken = match;
    std::sort(taken.begin(), taken.end());
    EXPECT_EQ(std::unique(taken.begin(), taken.end()), taken.end()) << "a column taken twice";
    EXPECT_NEAR(costOf(cost, columns, match), leastCost(cost, rows, columns), 1e-12) << trial;
  }
}

TEST(Matching, EqualCostsGoToTheFirstColumns) {
  EXPECT_EQ(hungarian(std::vector<double>(6, 1.0), 2, 3), (std::vector<int>{0, 1}));
  EXPECT_TRUE(hungarian({}, 0, 3).empty());
}

TEST(Matching, RefusesMoreRowsThanColumns) {
  EXPECT_THROW(hungarian({1.0, 2.0}, 2, 1), std::invalid_argument);
}

}  // namespace
}  // namespace cdiff::planners
