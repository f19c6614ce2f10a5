// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "guidance/collision_avoidance_objective.h"
#include "guidance/collision_seeking_objective.h"
#include "guidance/comfort_objective.h"
#include "guidance/drivable_area_objective.h"
#include "guidance/guidance_world.h"
#include "guidance/objective_registry.h"
#include "guidance/proximity.h"
#include "guidance/route_objective.h"
#include "guidance/speed_objective.h"
#include "guidance/traffic_avoidance_objective.h"
#include "support/network_text.h"

namespace cdiff::guidance {
namespace {

using test::gradientOf;
using test::GuidanceWorld;
using test::standing;
using test::valueOf;
using traffic::Rollout;

/// A rollout after a small step downhill.
Rollout descended(const Objective& objective, const GuidanceScene& scene, const Rollout& rollout) {
  return rollout - 1e-3 * gradientOf(objective, scene, rollout);
}

TEST(SpeedObjective, IsTheSumOfSquaresAndPullsToTheTarget) {
  GuidanceWorld world;
  Rollout rollout = standing(0.0, 0.0, 0.0, 5.0, 2);
  rollout(1, traffic::kRolloutSpeed) = 9.0;
  EXPECT_DOUBLE_EQ(valueOf(SpeedObjective(), world.scene(), rollout), 9.0 + 1.0);  // v* = 8
  const Rollout after = descended(SpeedObjective(), world.scene(), rollout);
  EXPECT_GT(after(0, traffic::kRolloutSpeed), 5.0);
  EXPECT_LT(after(1, traffic::kRolloutSpeed), 9.0);
  SpeedObjective half;
  half.factor = 0.5;
  EXPECT_DOUBLE_EQ(valueOf(half, world.scene(), rollout), 1.0 + 25.0);
}

TEST(TrafficAvoidanceObjective, CountsWhatIsMissingOfTheGapToALeader) {
  GuidanceWorld world;
  world.scene().traffic.clear();
  world.addTraffic(60.0, 0.0, 0.0);  // 20 m ahead; A = 4.5 + 4, B = 1.8 + 0.8
  const TrafficAvoidanceObjective objective;
  EXPECT_EQ(valueOf(objective, world.scene(), standing(11.4, 0, 0, 0, 1)), 0.0);
  EXPECT_NEAR(valueOf(objective, world.scene(), standing(13.5, 0, 0, 0, 1)), 4.0, 1e-9);
  const double window = std::pow(1.0 - 0.25, 2);
  EXPECT_NEAR(valueOf(objective, world.scene(), standing(13.5, 1.3, 0, 0, 1)), 4.0 * window, 1e-9);
  EXPECT_EQ(valueOf(objective, world.scene(), standing(13.5, 2.6, 0, 0, 1)), 0.0);
}

TEST(TrafficAvoidanceObjective, DrawsAPlanThroughALeaderBackBehindIt) {
  GuidanceWorld world;
  world.scene().traffic.clear();
  world.addTraffic(60.0, 0.0, 0.05);
  const Rollout beyond = standing(27.0, 0.0);
  EXPECT_LT(descended(TrafficAvoidanceObjective(), world.scene(), beyond)(0, traffic::kRolloutX),
            27.0);
}

// The vehicle is 5 m behind and 1 m beside the other in the other's frame; A = 8.5, B = 2.6. One
// that heads the same way, within 60 degrees, is a leader: (1 - (1 / B)^2)^2 (A - 5)^2. One that
// crosses is passed: A^2 (1 - rho)^2 with rho^2 = (5 / A)^2 + (1 / B)^2 + 1e-4, and so is one that
// is 5 m behind.
TEST(TrafficAvoidanceObjective, TakesOnlyWhoHeadsTheSameWayForALeader) {
  GuidanceWorld world;
  const TrafficAvoidanceObjective objective;
  const double across = 1.0 / 2.6;
  const double behind = std::pow(1.0 - across * across, 2) * 3.5 * 3.5;
  const double rho = std::sqrt(std::pow(5.0 / 8.5, 2) + across * across + 1e-4);
  const double beside = 8.5 * 8.5 * std::pow(1.0 - rho, 2);
  const auto value = [&](double along, double degrees) {
    const double heading = core::degreesToRadians(degrees);
    const Eigen::Vector2d forward = geometry::direction(heading);
    const Eigen::Vector2d place =
        Eigen::Vector2d(40.0, 0.0) - along * forward - geometry::leftNormal(forward);
    world.scene().traffic.clear();
    world.addTraffic(place.x(), place.y(), heading);
    return valueOf(objective, world.scene(), standing(0, 0, 0, 0, 1));
  };
  for (const double degrees : {0.0, 59.0, -59.0})
    EXPECT_NEAR(value(-5.0, degrees), behind, 1e-9) << degrees;
  for (const double degrees : {61.0, -61.0, 90.0})
    EXPECT_NEAR(value(-5.0, degrees), beside, 1e-9) << degrees;
  EXPECT_NEAR(value(5.0, 0.0), beside, 1e-9);
}

TEST(TrafficAvoidanceObjective, LeavesPassingTrafficAloneAndEvadesWhoComesNear) {
  GuidanceWorld world;
  world.scene().traffic.clear();
  world.addTraffic(50.0, 3.2, core::kPi);  // oncoming in the next lane
  const TrafficAvoidanceObjective objective;
  EXPECT_EQ(valueOf(objective, world.scene(), standing(10.0, 0.0)), 0.0);
  const Rollout near = standing(9.0, 1.6);
  EXPECT_GT(valueOf(objective, world.scene(), near), 0.0);
  EXPECT_LT(descended(objective, world.scene(), near)(0, traffic::kRolloutY), 1.6);
}

TEST(DrivableAreaObjective, CountsWhatIsMissingOfTheMargin) {
  GuidanceWorld world;
  // The lane reaches from -2 to 2 m. At 1.5: 1.2 - 0.5 = 0.7; at 3: 1.2 + 1 = 2.2; at 0.5: inside.
  EXPECT_NEAR(valueOf(DrivableAreaObjective(), world.scene(), standing(0, 1.5, 0, 0, 1)), 0.49,
              1e-9);
  EXPECT_NEAR(valueOf(DrivableAreaObjective(), world.scene(), standing(0, 3.0, 0, 0, 1)), 4.84,
              1e-9);
  EXPECT_EQ(valueOf(DrivableAreaObjective(), world.scene(), standing(0, 0.5, 0, 0, 1)), 0.0);
}

TEST(DrivableAreaObjective, PullsInsideEvenFromFarOutside) {
  GuidanceWorld world;
  for (const double offset : {1.5, 3.0, 30.0}) {
    const Rollout rollout = standing(0.0, offset);
    EXPECT_LT(descended(DrivableAreaObjective(), world.scene(), rollout)(0, traffic::kRolloutY),
              offset);
    EXPECT_GT(descended(DrivableAreaObjective(), world.scene(), standing(0.0, -offset))(
                  0, traffic::kRolloutY),
              -offset);
  }
}

TEST(DrivableAreaObjective, BumpersSeeABoxThatStandsAcross) {
  GuidanceWorld world;
  world.scene().dimensions.length = 4.0;
  DrivableAreaObjective objective;
  const Rollout across = standing(0.0, 0.0, 0.5 * core::kPi, 0.0, 1);
  EXPECT_EQ(valueOf(objective, world.scene(), across), 0.0);
  objective.points = "bumpers";
  // Front and rear are on the border: (1.2^2 + 0 + 1.2^2) / 3.
  EXPECT_NEAR(valueOf(objective, world.scene(), across), 0.96, 1e-9);
}

TEST(Softplus, IsSafeAtBothEnds) {
  EXPECT_EQ(softplus(1000.0), 1000.0);
  EXPECT_EQ(softplus(-1000.0), 0.0);
  EXPECT_DOUBLE_EQ(softplus(0.0), std::log(2.0));
  EXPECT_DOUBLE_EQ(softplus(1.0), std::log(1.0 + std::exp(1.0)));
}

TEST(CollisionAvoidance, IsThePapersSum) {
  GuidanceWorld world;
  world.setOther(50.0, 0.0);
  // Ten meters ahead; both boxes 4.5 x 1.8 m, so d_safe = sqrt(4.5^2 + 1.8^2) + 0.5.
  const double distance = std::sqrt(100.0 + 0.01);
  const double safe = std::hypot(4.5, 1.8) + 0.5;
  const double expected =
      std::log(1.0 + std::exp((safe - distance) / 2.0)) + std::exp(-100.01 / (2.0 * 16.0));
  EXPECT_NEAR(valueOf(CollisionAvoidanceObjective(), world.scene(), standing(0, 0, 0, 0, 3)),
              3.0 * expected, 1e-12);
}

TEST(CollisionAvoidance, DepartsAndSeekingApproaches) {
  GuidanceWorld world;
  for (const double distance : {1.0, 6.0, 20.0}) {
    world.setOther(40.0 + distance, 0.0);
    const Rollout rollout = standing(0.0, 0.0);
    EXPECT_LT(descended(CollisionAvoidanceObjective(), world.scene(), rollout)(0, 0), 0.0);
    EXPECT_GT(descended(CollisionSeekingObjective(), world.scene(), rollout)(0, 0), 0.0);
  }
}

TEST(CollisionSeeking, StillPullsFromTheTriggerDistance) {
  GuidanceWorld world;
  world.setOther(65.0, 0.0);
  // Logistic((5.35 - 25) / 6) / 6 = 0.0061 and 2 exp(-625 / 128) 25 / 64 = 0.0059 per meter.
  EXPECT_NEAR(gradientOf(CollisionSeekingObjective(), world.scene(), standing(0, 0))(0, 0), -0.0119,
              2e-4);
}

// Ours is 4.5 m long and at 40 m, its rear at 37.75 m.
TEST(CollisionSeeking, LeavesOneAloneThatStandsBehind) {
  GuidanceWorld world;
  CollisionSeekingObjective objective;
  objective.leave_behind = true;
  const auto seeks = [&] { return valueOf(objective, world.scene(), standing(0.0, 0.0)) != 0.0; };
  world.setOther(35.4, 0.0);  // its front at 37.65 m
  EXPECT_FALSE(seeks());
  world.other().now.speed = 1.0;  // it comes
  EXPECT_TRUE(seeks());
  world.setOther(35.6, 1.9);  // beside our rear
  EXPECT_TRUE(seeks());
  world.setOther(30.0, 0.0);
  objective.leave_behind = false;
  EXPECT_TRUE(seeks());
}

TEST(CollisionSeeking, MeetingCentersGiveFiniteNumbers) {
  GuidanceWorld world;
  world.setOther(40.0, 0.0);
  const Rollout gradient =
      gradientOf(CollisionSeekingObjective(), world.scene(), standing(0.0, 0.0));
  EXPECT_EQ(gradient, Rollout::Zero(test::kRows, traffic::kRolloutColumns));
  EXPECT_TRUE(
      std::isfinite(valueOf(CollisionSeekingObjective(), world.scene(), standing(0.0, 0.0))));
}

TEST(CollisionSeeking, GateIsOneThenFallsToExactlyZero) {
  CollisionSeekingObjective objective;  // 25 m, fading over 10 m
  EXPECT_EQ(objective.gateAt(25.0), 1.0);
  EXPECT_DOUBLE_EQ(objective.gateAt(30.0), 0.5);
  EXPECT_DOUBLE_EQ(objective.gateAt(27.5), 1.0 - 0.0625 * 2.5);
  EXPECT_EQ(objective.gateAt(35.0), 0.0);
  EXPECT_EQ(objective.gateAt(40.0), 0.0);
  objective.gate = "hard";
  EXPECT_EQ(objective.gateAt(25.0), 1.0);
  EXPECT_EQ(objective.gateAt(25.001), 0.0);
}

TEST(CollisionSeeking, ClosedGateIsExactlyZeroAndHalfOpenHalf) {
  GuidanceWorld world;
  world.other().now = world.placed(75.0, 0.0, 0.0, 0.0);  // 35 m now, but predicted near
  const Rollout rollout = test::wandering(1);
  CollisionSeekingObjective objective;
  EXPECT_EQ(valueOf(objective, world.scene(), rollout), 0.0);
  EXPECT_EQ(gradientOf(objective, world.scene(), rollout),
            Rollout::Zero(test::kRows, traffic::kRolloutColumns));
  world.other().now = world.placed(70.0, 0.0, 0.0, 0.0);
  CollisionAvoidanceObjective safe;
  safe.proximity = objective.proximity;
  EXPECT_NEAR(valueOf(objective, world.scene(), rollout),
              -0.5 * valueOf(safe, world.scene(), rollout), 1e-9);
}

TEST(Collision, IgnoresNobodyAndBridgesAndUnknownRows) {
  GuidanceWorld world;
  const Rollout rollout = test::wandering(2);
  const CollisionAvoidanceObjective objective;
  world.other().predicted.resize(3);
  const Rollout gradient = gradientOf(objective, world.scene(), rollout);
  EXPECT_NE(gradient(2, 0), 0.0);
  EXPECT_EQ(gradient(3, 0), 0.0);
  world.other().now.elevation = 6.0;
  EXPECT_EQ(valueOf(objective, world.scene(), rollout), 0.0);
  world.scene().other = nullptr;
  EXPECT_EQ(valueOf(objective, world.scene(), rollout), 0.0);
  EXPECT_EQ(valueOf(CollisionSeekingObjective(), world.scene(), rollout), 0.0);
}

TEST(RouteObjective, CountsTheOffsetBeyondTheCorridor) {
  GuidanceWorld world;
  EXPECT_NEAR(valueOf(RouteObjective(), world.scene(), standing(3, 2, 0, 0, 1)), 2.25, 1e-9);
  EXPECT_NEAR(valueOf(RouteObjective(), world.scene(), standing(3, -2, 0, 0, 1)), 2.25, 1e-9);
  EXPECT_EQ(valueOf(RouteObjective(), world.scene(), standing(3, 0.4, 0, 0, 1)), 0.0);
  EXPECT_LT(descended(RouteObjective(), world.scene(), standing(3, 2))(0, 1), 2.0);
  EXPECT_GT(descended(RouteObjective(), world.scene(), standing(3, -2))(0, 1), -2.0);
  // Beyond the route's end only the side counts, and so it does before the part that is looked at.
  EXPECT_NEAR(valueOf(RouteObjective(), world.scene(), standing(70, 2, 0, 0, 1)), 2.25, 1e-9);
  EXPECT_NEAR(valueOf(RouteObjective(), world.scene(), standing(-15, 2, 0, 0, 1)), 2.25, 1e-9);
  RouteObjective turned;
  turned.heading_weight = 4.0;
  EXPECT_NEAR(valueOf(turned, world.scene(), standing(3, 0, 0.5, 0, 1)), 1.0, 1e-9);
  world.scene().route = nullptr;
  EXPECT_EQ(valueOf(turned, world.scene(), standing(3, 2, 0.5)), 0.0);
}

// East for 100 m along y = 0, 4 m north and back west along y = 4. The vehicle is on its way back
// at x = 50, arc length 154; a place 2.1 m left of it, y = 1.9, is nearer to the way out (1.9 m),
// which it passed long ago and which leads the other way.
TEST(RouteObjective, TakesThePassOfALoopThatTheVehicleIsOn) {
  const map::RoadNetwork network =
      test::NetworkText().edge("loop", {"0,0 100,0 100,4 0,4"}).network();
  const map::Route route = map::matchRoute(
      network, {{0, 0, 0}, {50, 0, 0}, {100, 0, 0}, {100, 4, 0}, {50, 4, 0}, {0, 4, 0}});
  GuidanceWorld world;
  world.scene().route = &route;
  world.scene().route_arc_length = 154.0;
  world.scene().state.position = {50.0, 4.0};
  world.scene().state.heading = core::kPi;
  RouteObjective objective;
  objective.heading_weight = 4.0;
  const double excess = 2.1 - objective.free_offset;
  EXPECT_NEAR(valueOf(objective, world.scene(), standing(3, 2.1, 0, 0, 1)), excess * excess, 1e-9);
}

TEST(ComfortObjective, CountsChangesOfActionAndLateralAcceleration) {
  GuidanceWorld world;
  Rollout rollout = standing(0.0, 0.0, 0.05, 10.0, 2);
  rollout(1, traffic::kRolloutThrottle) = 0.5;
  // First row: 10 m/s x 0.05 rad / 0.1 s = 5 m/s^2, x 0.1 = 2.5; second row: no turn, 0.5^2.
  EXPECT_NEAR(valueOf(ComfortObjective(), world.scene(), rollout), 2.5 + 0.25, 1e-12);
  const Rollout after = descended(ComfortObjective(), world.scene(), rollout);
  EXPECT_GT(after(0, traffic::kRolloutThrottle), 0.0);
  EXPECT_LT(after(1, traffic::kRolloutThrottle), 0.5);
  EXPECT_LT(after(0, traffic::kRolloutHeading), 0.05);
}

TEST(ObjectiveFactory, KnowsItsNamesAndNamesTheNearest) {
  for (const std::string& name : objectiveNames()) {
    EXPECT_NE(makeObjective(name), nullptr);
    EXPECT_FALSE(std::string(objectiveText(name)).empty());
  }
  try {
    makeObjective("colision_avoidance");
    FAIL() << "no error";
  } catch (const core::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("'collision_avoidance'"), std::string::npos)
        << error.what();
  }
}

TEST(Objectives, CloneKeepsTheOptions) {
  SpeedObjective objective;
  objective.factor = 0.25;
  GuidanceWorld world;
  EXPECT_EQ(valueOf(*objective.clone(), world.scene(), standing(0, 0, 0, 2, 3)), 0.0);
}

}  // namespace
}  // namespace cdiff::guidance
