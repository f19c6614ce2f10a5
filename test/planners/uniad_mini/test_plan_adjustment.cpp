// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "planners/uniad_mini/uniad_mini.h"

namespace cdiff::planners {
namespace {

/// 10 m a step straight on.
EgoWaypoints longPlan() {
  EgoWaypoints plan;
  for (std::size_t i = 0; i < plan.size(); ++i) plan[i] = {10.0 * static_cast<double>(i + 1), 0.0};
  return plan;
}

// An occupied place 1 m to the right: 5 / 2.5066 x exp(-1/2) = 1.9947 x 0.60653 = 1.20985, which
// falls to the left.
TEST(PlanAdjustment, CostIsTheFormula) {
  const RepulsionCost cost = repulsionCost({10.0, 0.0}, {10.0, 0.0}, {{10.0, -1.0}}, {});
  EXPECT_NEAR(cost.value, 1.20985, 1e-5);
  EXPECT_NEAR(cost.gradient.x(), 0.0, 1e-12);
  EXPECT_NEAR(cost.gradient.y(), -1.20985, 1e-5);
  EXPECT_EQ(repulsionCost({10.0, 0.0}, {10.0, 0.0}, {{10.0, -5.1}}, {}).value, 0.0) << "too far";
  const RepulsionCost away = repulsionCost({10.0, 2.0}, {10.0, 0.0}, {}, {});
  EXPECT_EQ(away.value, 4.0);
  EXPECT_EQ(away.gradient, Eigen::Vector2d(0.0, 4.0));
}

TEST(PlanAdjustment, GradientIsThatOfTheCost) {
  const std::vector<Eigen::Vector2d> occupied = {{9.0, -1.0}, {11.5, 0.7}, {12.0, -2.0}};
  const Eigen::Vector2d planned(10.0, 0.0), at(10.4, 0.3);
  const RepulsionCost cost = repulsionCost(at, planned, occupied, {});
  constexpr double kStep = 1e-5;
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(axis);
    const double difference = repulsionCost(at + step, planned, occupied, {}).value -
                              repulsionCost(at - step, planned, occupied, {}).value;
    EXPECT_NEAR(cost.gradient[axis], difference / (2.0 * kStep), 1e-6);
  }
}

// The cost y^2 + 1.9947 exp(-(y + 1)^2 / 2) is smallest where 2 y = 1.9947 (y + 1) exp(-(y + 1)^2 /
// 2): at y = 0.4898, where both sides are 0.9796.
TEST(PlanAdjustment, MovesWaypointsToTheSmallestCost) {
  OccupiedPlaces occupied;
  occupied[1] = {{10.0, -1.0}};
  const EgoWaypoints plan = adjustedPlan(longPlan(), occupied, {});
  EXPECT_NEAR(plan[0].y(), 0.4898, 5e-3);
  EXPECT_NEAR(plan[0].x(), 10.0, 1e-9);
  for (std::size_t i = 1; i < plan.size(); ++i) EXPECT_EQ(plan[i], longPlan()[i]) << i;
}

// Waypoint i is 0.5 (i + 1) s ahead, as occupancy step i + 1 is; the last two look at the last one.
TEST(PlanAdjustment, LooksAtTheOccupancyOfTheSameTime) {
  OccupiedPlaces occupied;
  occupied[0] = {{10.0, -1.0}};
  occupied[4] = {{50.0, -1.0}, {60.0, -1.0}, {30.0, -1.0}};
  const EgoWaypoints plan = adjustedPlan(longPlan(), occupied, {});
  EXPECT_EQ(plan[0], longPlan()[0]) << "what is occupied now does not count";
  EXPECT_EQ(plan[2], longPlan()[2]);
  EXPECT_NEAR(plan[4].y(), 0.4898, 5e-3);
  EXPECT_NEAR(plan[5].y(), 0.4898, 5e-3);
}

TEST(PlanAdjustment, NeverRaisesTheCostWhateverTheStep) {
  PlanAdjustmentOptions options;
  options.step_length = 0.5;
  options.weight = 200.0;
  OccupiedPlaces occupied;
  occupied[1] = {{10.3, -0.2}, {9.5, 0.9}, {11.0, 1.0}};
  const EgoWaypoints plan = adjustedPlan(longPlan(), occupied, options);
  const Eigen::Vector2d planned = longPlan()[0];
  EXPECT_LT(repulsionCost(plan[0], planned, occupied[1], options).value,
            repulsionCost(planned, planned, occupied[1], options).value);
}

TEST(PlanAdjustment, CanBeSwitchedOff) {
  PlanAdjustmentOptions options;
  options.adjust = false;
  OccupiedPlaces occupied;
  occupied[1] = {{10.0, -1.0}};
  EXPECT_EQ(adjustedPlan(longPlan(), occupied, options), longPlan());
}

/// Two agents and three cells at step 0: the second agent is not there.
PredictedOccupancy threeCells() {
  PredictedOccupancy occupancy;
  occupancy.cells = 3;
  occupancy.sure = {true, false};
  occupancy.logits[0] = {0.0F, 2.0F, -2.0F, 100.0F, 100.0F, 100.0F};
  return occupancy;
}

// 1 / (1 + exp(-2)) = 0.8808.
TEST(Occupancy, IsTheLargestProbabilityOfAgentsThatAreThere) {
  PredictedOccupancy occupancy = threeCells();
  std::vector<float> probability = occupancy.probability(0);
  ASSERT_EQ(probability.size(), 3U);
  EXPECT_NEAR(probability[0], 0.5F, 1e-6F);
  EXPECT_NEAR(probability[1], 0.8808F, 1e-4F);
  EXPECT_NEAR(probability[2], 0.1192F, 1e-4F);
  occupancy.sure[1] = true;
  EXPECT_NEAR(occupancy.probability(0)[2], 1.0F, 1e-6F);
}

TEST(Occupancy, PlacesAreCentersOfCells) {
  const BevGrid bev{32, 32, 2.0, 16.0};
  std::vector<float> probability(1024, 0.0F);
  probability[33] = 0.5F;  // row 1, column 1: 3 m from either corner
  probability[34] = 0.49F;
  const auto places = occupiedPlaces(bev, probability, 0.5);
  ASSERT_EQ(places.size(), 1U);
  EXPECT_EQ(places[0], Eigen::Vector2d(-13.0, -29.0));
}

TEST(Occupancy, IsShownForEveryStep) {
  const BevGrid bev{1, 3, 2.0, 16.0};
  PredictedOccupancy occupancy = threeCells();
  for (std::size_t i = 1; i < 5; ++i) occupancy.logits[i] = occupancy.logits[0];
  traffic::VehicleState ego;
  ego.position = {7.0, 8.0};
  const auto shown = perceivedOccupancy(bev, occupancy, ego);
  ASSERT_EQ(shown.size(), 5U);
  EXPECT_EQ(shown[3].time, 1.5);
  EXPECT_EQ(shown[3].frame.position, ego.position);
  EXPECT_EQ(shown[3].columns, 3);
  EXPECT_EQ(shown[3].origin, Eigen::Vector2d(-16.0, -3.0));
  EXPECT_EQ(shown[3].probability, occupancy.probability(3));
}

// Cells of two rows and three columns; beyond them there is nothing.
TEST(NeighborCells, AreReadRowByRow) {
  const auto neighbors = neighborCells({2, 3});
  const std::vector<std::int64_t> first(neighbors.begin(), neighbors.begin() + 9);
  const std::vector<std::int64_t> fifth(neighbors.begin() + 36, neighbors.begin() + 45);
  EXPECT_EQ(first, (std::vector<std::int64_t>{-1, -1, -1, -1, 0, 1, -1, 3, 4}));
  EXPECT_EQ(fifth, (std::vector<std::int64_t>{0, 1, 2, 3, 4, 5, -1, -1, -1}));
}

// Two rows of four cells whose values are their numbers: (0 + 1 + 4 + 5) / 4 and (2 + 3 + 6 + 7)
// / 4.
TEST(NeighborCells, AreHalvedByMeans) {
  inference::Rows cells, half;
  cells.resize(8, 16);
  for (std::int64_t cell = 0; cell < 8; ++cell)
    std::fill_n(cells.row(cell), 16, static_cast<float>(cell));
  halveMap({2, 4}, cells, 16, half);
  ASSERT_EQ(half.rows(), 2);
  EXPECT_EQ(half.row(0)[15], 2.5F);
  EXPECT_EQ(half.row(1)[0], 4.5F);
  EXPECT_EQ(halvedCell({2, 4}, 6), 1);
}

}  // namespace
}  // namespace cdiff::planners
