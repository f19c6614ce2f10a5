// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "diffusion/network/architecture.h"

namespace cdiff::diffusion {
namespace {

geometry::Pose2d poseAt(double x, double y, double heading) {
  return {Eigen::Vector2d(x, y), heading};
}

/// Circle of radius 20 m from (0, 0) eastwards; side 1 turns left, -1 right. 2.6 rad in 2600
/// chords.
geometry::Polyline circle(double side) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i <= 2600; ++i) {
    const double angle = 0.001 * i;
    points.emplace_back(20.0 * std::sin(angle), side * 20.0 * (1.0 - std::cos(angle)), 0.0);
  }
  return geometry::Polyline(points);
}

TEST(RouteTokens, StraightAhead) {
  // North along x = 5; the vehicle is at (6, 10), 1 m right of the route, and heads north: point i
  // (i = 1..16) lies 3 i meters ahead and 1 m to the left, divided by 20.
  const geometry::Polyline path({{5.0, 0.0, 0.0}, {5.0, 100.0, 0.0}});
  const std::vector<float> tokens =
      routeTokens(Architecture(), path, 10.0, poseAt(6.0, 10.0, std::acos(-1.0) / 2.0));
  ASSERT_EQ(tokens.size(), 32u);
  for (int i = 1; i <= 16; ++i) {
    EXPECT_NEAR(tokens[2 * i - 2], 3.0 * i / 20.0, 1e-6) << i;
    EXPECT_NEAR(tokens[2 * i - 1], 1.0 / 20.0, 1e-6) << i;
  }
}

TEST(RouteTokens, GoesStraightOnBeyondTheEnd) {
  // 10 m east, then 5 m north to (10, 5): from arc length 12 the points lie at 15 (the end), then
  // 3, 6, ... meters farther north.
  const geometry::Polyline path({{0.0, 0.0, 0.0}, {10.0, 0.0, 0.0}, {10.0, 5.0, 0.0}});
  const std::vector<float> tokens = routeTokens(Architecture(), path, 12.0, poseAt(0.0, 0.0, 0.0));
  for (int i = 1; i <= 16; ++i) {
    EXPECT_NEAR(tokens[2 * i - 2], 0.5, 1e-6) << i;
    EXPECT_NEAR(tokens[2 * i - 1], (5.0 + 3.0 * (i - 1)) / 20.0, 1e-6) << i;
  }
  // A place beyond the end counts too: arc length 20 is 5 m beyond it.
  const std::vector<float> beyond = routeTokens(Architecture(), path, 20.0, poseAt(0.0, 0.0, 0.0));
  EXPECT_NEAR(beyond[1], (5.0 + 5.0 + 3.0) / 20.0, 1e-6);
}

TEST(RouteTokens, Circle) {
  // Radius 20 m: at arc length s the route is at 20 (sin(s / 20), 1 - cos(s / 20)), divided by 20.
  const std::vector<float> tokens =
      routeTokens(Architecture(), circle(1.0), 0.0, poseAt(0.0, 0.0, 0.0));
  for (int i = 1; i <= 16; ++i) {
    EXPECT_NEAR(tokens[2 * i - 2], std::sin(3.0 * i / 20.0), 1e-6) << i;
    EXPECT_NEAR(tokens[2 * i - 1], 1.0 - std::cos(3.0 * i / 20.0), 1e-6) << i;
  }
}

TEST(RouteTokens, MirrorImage) {
  const std::vector<float> left =
      routeTokens(Architecture(), circle(1.0), 1.0, poseAt(1.0, 0.5, 0.1));
  const std::vector<float> right =
      routeTokens(Architecture(), circle(-1.0), 1.0, poseAt(1.0, -0.5, -0.1));
  for (std::size_t i = 0; i < left.size(); i += 2) {
    EXPECT_EQ(left[i], right[i]) << i;
    EXPECT_EQ(left[i + 1], -right[i + 1]) << i;
  }
  EXPECT_GT(left[31], 1.0F);
}

TEST(RouteTokens, CountAndSpacingAreThoseOfTheArchitecture) {
  Architecture architecture;
  architecture.route_points = 2;
  architecture.route_spacing = 5.0;
  const geometry::Polyline path({{0.0, 0.0, 0.0}, {100.0, 0.0, 0.0}});
  const std::vector<float> tokens = routeTokens(architecture, path, 0.0, poseAt(0.0, 0.0, 0.0));
  EXPECT_EQ(tokens, (std::vector<float>{0.25F, 0.0F, 0.5F, 0.0F}));
}

TEST(RouteTokens, RefusesAnEmptyPath) {
  EXPECT_THROW(routeTokens(Architecture(), geometry::Polyline(), 0.0, poseAt(0.0, 0.0, 0.0)),
               std::invalid_argument);
}

}  // namespace
}  // namespace cdiff::diffusion
