// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>

#include "rendering/road_scene.h"

namespace cdiff::rendering {
namespace {

double areaOf(const std::vector<std::array<Eigen::Vector3d, 3>>& triangles) {
  double area = 0.0;
  for (const auto& [a, b, c] : triangles) {
    area += 0.5 * std::abs((b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x()));
  }
  return area;
}

/// An L of 3 x 3 without its upper right 2 x 2: area 9 - 4 = 5.
const std::vector<Eigen::Vector3d> kAngle = {{0, 0, 1}, {3, 0, 1}, {3, 1, 1},
                                             {1, 1, 1}, {1, 3, 2}, {0, 3, 2}};

TEST(Triangulation, FillsANotConvexOutlineOnce) {
  const auto triangles = triangulate(kAngle);
  EXPECT_EQ(triangles.size(), 4u);  // corners - 2
  EXPECT_NEAR(areaOf(triangles), 5.0, 1e-12);
}

TEST(Triangulation, TurningDirectionAndRepeatedPointsDoNotMatter) {
  std::vector<Eigen::Vector3d> outline(kAngle.rbegin(), kAngle.rend());
  outline.push_back(outline.front());
  outline.insert(outline.begin() + 2, outline[2]);
  EXPECT_NEAR(areaOf(triangulate(outline)), 5.0, 1e-12);
}

TEST(Triangulation, NothingFromFewerThanThreePoints) {
  EXPECT_TRUE(triangulate({}).empty());
  EXPECT_TRUE(triangulate({{0, 0, 0}, {1, 0, 0}}).empty());
}

}  // namespace
}  // namespace cdiff::rendering
