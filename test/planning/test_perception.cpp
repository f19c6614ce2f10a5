// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "e2e_cdiff/planning/perception.h"
#include "planning/perception_sample.h"

namespace cdiff::planning {
namespace {

TEST(Perception, TheLikeliestForecastIsTheFirstOfTheLargestProbability) {
  std::vector<PerceivedForecast> forecasts = test::samplePerception().vehicles[0].forecasts;
  EXPECT_EQ(likeliest(forecasts).probability, 0.6);
  forecasts.push_back({{}, 0.6});
  EXPECT_EQ(&likeliest(forecasts), &forecasts[1]);
}

// Row 0, column 1: 1 + 0.5 ahead, -1.5 + 1.5 to the left; row 1, column 2: 2.5 ahead, 1 to the
// left.
TEST(Perception, CellsAboveAHalfAreOccupied) {
  const auto cells = occupiedCells(test::samplePerception().occupancy[0]);
  ASSERT_EQ(cells.size(), 2U) << "one half itself is not above";
  EXPECT_EQ(cells[0], Eigen::Vector2d(1.5, 0.0));
  EXPECT_EQ(cells[1], Eigen::Vector2d(2.5, 1.0));
}

}  // namespace
}  // namespace cdiff::planning
