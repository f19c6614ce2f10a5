// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "planners/two_stage_pid/pdm_lite_tracker.h"

namespace cdiff::planners {
namespace {

/// Places of a plan along +x at a constant speed.
Eigen::MatrixX2d ahead(double speed) {
  Eigen::MatrixX2d places = Eigen::MatrixX2d::Zero(32, 2);
  for (Eigen::Index row = 0; row < 32; ++row)
    places(row, 0) = 0.1 * speed * static_cast<double>(row + 1);
  return places;
}

TEST(PointAlong, MeasuresAlongTheLineFromTheVehicleOn) {
  // 3 m ahead, then 4 m to the left.
  Eigen::MatrixX2d places(2, 2);
  places << 3.0, 0.0, 3.0, 4.0;
  EXPECT_TRUE(pointAlong(places, 1.5).isApprox(Eigen::Vector2d(1.5, 0.0)));
  EXPECT_TRUE(pointAlong(places, 3.0).isApprox(Eigen::Vector2d(3.0, 0.0)));
  EXPECT_TRUE(pointAlong(places, 5.0).isApprox(Eigen::Vector2d(3.0, 2.0)));
  EXPECT_TRUE(pointAlong(places, 9.0).isApprox(Eigen::Vector2d(3.0, 4.0)));
  EXPECT_TRUE(pointAlong(Eigen::MatrixX2d(0, 2), 9.0).isZero());
}

TEST(PdmLiteTracker, SteersTowardThePointAtPdmLitesLookAhead) {
  // At 8 m/s: floor(0.9755322 x 28.8 + 1.9152885) = floor(30.01) points of 0.1 m, 3.0 m. The plan
  // goes to (0.8, 0.08), (1.6, 0.16) ... on a straight line: atan(0.1) / (pi / 2) = 0.0634510; x
  // (2.0 + 0.6406068 / 20 + 1.3782509) = 0.2164, rounded to 3 decimals.
  Eigen::MatrixX2d places = ahead(8.0);
  places.col(1) = 0.1 * places.col(0);
  EXPECT_NEAR(PdmLiteTracker(1.0).track(8.0, places).steer, 0.216, 1e-9);
  // Only what lies 3 m ahead counts.
  places = ahead(8.0);
  places.bottomRows(28).col(1).setConstant(1.0);
  EXPECT_EQ(PdmLiteTracker(1.0).track(8.0, places).steer, 0.0);
}

TEST(PdmLiteTracker, PedalsAreThoseOfPdmLiteForThePlansSpeed) {
  // Published: full throttle 1.89 km/h below the target, full brake above 1.0313 of it.
  EXPECT_EQ(PdmLiteTracker(1.0).track(7.4, ahead(8.0)).throttle, 1.0);
  EXPECT_EQ(PdmLiteTracker(1.0).track(8.26, ahead(8.0)).brake, 1.0);
  const traffic::ControlAction held = PdmLiteTracker(1.0).track(8.24, ahead(8.0));
  EXPECT_EQ(held.brake, 0.0);
  EXPECT_GT(held.throttle, 0.0);
  EXPECT_LT(held.throttle, 1.0);
  // 6 m in the first second, then none: 6 m/s over 1 s, 2 m/s over 3 s.
  Eigen::MatrixX2d places = ahead(6.0);
  places.bottomRows(22).col(0).setConstant(6.0);
  EXPECT_EQ(PdmLiteTracker(1.0).track(5.0, places).throttle, 1.0);
  EXPECT_EQ(PdmLiteTracker(3.0).track(5.0, places).brake, 1.0);
}

TEST(PdmLiteTracker, APlanToStandBrakesWithoutSteering) {
  EXPECT_EQ(PdmLiteTracker(1.0).track(5.0, ahead(0.0)), traffic::ControlAction::failSafe());
  // Nothing nearer than 1 m is steered to.
  Eigen::MatrixX2d places = Eigen::MatrixX2d::Zero(32, 2);
  places.col(1).setConstant(0.9);
  EXPECT_EQ(PdmLiteTracker(1.0).track(5.0, places).steer, 0.0);
}

}  // namespace
}  // namespace cdiff::planners
