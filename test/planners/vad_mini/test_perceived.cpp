// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// What a network's numbers mean in the map frame.
#include <gtest/gtest.h>

#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "planners/vad_mini/vad_mini.h"

namespace cdiff::planners {
namespace {

/// The ego at (10, 20) and 3 m up looks along y: (x, y) of the body frame is (10 - y, 20 + x).
traffic::VehicleState ego() {
  traffic::VehicleState state;
  state.position = {10.0, 20.0};
  state.elevation = 3.0;
  state.heading = 0.5 * core::kPi;
  return state;
}

DetectedAgent agent(float score) {
  DetectedAgent seen;
  seen.score = score;
  seen.box = {4.0F,           1.0F,           std::log(1.9F), std::log(4.6F), -0.5F,
              std::log(1.6F), std::sin(0.3F), std::cos(0.3F), 3.0F,           -4.0F};
  for (std::size_t mode = 0; mode < seen.ways.size(); ++mode) {
    for (std::size_t i = 0; i < seen.ways[mode].size(); ++i)
      seen.ways[mode][i] = {4.0 + static_cast<double>(i), static_cast<double>(mode)};
    seen.way_scores[mode] = static_cast<float>(mode) - 2.0F;
  }
  return seen;
}

TEST(Perceived, VehiclesAreGivenInTheMap) {
  VadMiniOutput output;
  output.agents = {agent(-0.1F), agent(2.0F)};
  const planning::Perception perception = perceptionOf(output, ego(), 0.5);
  ASSERT_EQ(perception.vehicles.size(), 1U) << "-0.1 is less than a half";
  const planning::PerceivedVehicle& seen = perception.vehicles[0];
  EXPECT_NEAR(seen.score, 1.0 / (1.0 + std::exp(-2.0)), 1e-9);
  EXPECT_NEAR(seen.state.position.x(), 9.0, 1e-6);
  EXPECT_NEAR(seen.state.position.y(), 24.0, 1e-6);
  EXPECT_NEAR(seen.state.elevation, 2.5, 1e-6);
  EXPECT_NEAR(seen.state.heading, 0.5 * core::kPi + 0.3, 1e-6);
  EXPECT_NEAR(seen.state.speed, 5.0, 1e-6);
  EXPECT_NEAR(seen.dimensions.length, 4.6, 1e-6);
  EXPECT_NEAR(seen.dimensions.width, 1.9, 1e-6);
  EXPECT_NEAR(seen.dimensions.height, 1.6, 1e-6);
  ASSERT_EQ(seen.forecasts.size(), 6U);
  for (std::size_t mode = 0; mode < 6; ++mode) {
    EXPECT_NEAR(seen.forecasts[mode].probability, 1.0 / (1.0 + std::exp(2.0 - mode)), 1e-9);
    ASSERT_EQ(seen.forecasts[mode].places.size(), 6U);
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_NEAR(seen.forecasts[mode].places[i].x(), 10.0 - static_cast<double>(mode), 1e-9);
      EXPECT_NEAR(seen.forecasts[mode].places[i].y(), 24.0 + static_cast<double>(i), 1e-9);
    }
  }
}

// The kind of the best score; points lie 1 m apart ahead, 2 m to the left.
TEST(Perceived, LinesAreOfTheirLikeliestKind) {
  DetectedLine line;
  for (std::size_t i = 0; i < line.points.size(); ++i)
    line.points[i] = {static_cast<double>(i), 2.0};
  VadMiniOutput output;
  const std::array<float, 3> scores[] = {
      {1.0F, -2.0F, 0.0F}, {-2.0F, 1.0F, 0.0F}, {-0.3F, -0.2F, -0.1F}, {0.2F, 0.0F, 1.0F}};
  for (const std::array<float, 3>& of_line : scores) {
    line.scores = of_line;
    output.lines.push_back(line);
  }
  const planning::Perception perception = perceptionOf(output, ego(), 0.5);
  ASSERT_EQ(perception.lines.size(), 3U);
  const char* kinds[] = {"edge", "divider", "center"};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(perception.lines[i].kind, kinds[i]);
    EXPECT_NEAR(perception.lines[i].score, 1.0 / (1.0 + std::exp(-1.0)), 1e-9);
    for (std::size_t p = 0; p < line.points.size(); ++p) {
      EXPECT_NEAR(perception.lines[i].points[p].x(), 8.0, 1e-9);
      EXPECT_NEAR(perception.lines[i].points[p].y(), 20.0 + static_cast<double>(p), 1e-9);
    }
  }
  EXPECT_EQ(perceptionOf(output, ego(), 0.0).lines.size(), 4U);
  EXPECT_TRUE(perceptionOf(output, ego(), 0.8).lines.empty());
}

TEST(Perceived, NumbersThatAreNotFiniteAreFound) {
  VadMiniOutput output;
  for (auto& plan : output.plans) plan.fill({0.0, 0.0});  // Eigen leaves them as they are
  output.agents = {agent(0.0F)};
  EXPECT_TRUE(output.finite());
  output.plans[3][2].y() = std::nan("");
  EXPECT_FALSE(output.finite());
}

}  // namespace
}  // namespace cdiff::planners
