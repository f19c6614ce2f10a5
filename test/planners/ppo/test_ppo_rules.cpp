// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "planners/course.h"
#include "planners/ppo/ppo_rules.h"
#include "support/snapshot_builder.h"

namespace cdiff::planners {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class PpoRules : public ::testing::Test {
 protected:
  PpoRules() {
    snapshot_.vehicles.push_back(
        test::vehicle("cbv", {10.0, 5.0, 90.0, 4.0}, traffic::VehicleRole::kCbv));
  }
  PpoObservation observe(const PpoGoal& goal) const {
    return ppoObservation(snapshot_, *snapshot_.ego(), *snapshot_.find("cbv"), goal);
  }
  static std::vector<double> row(const PpoObservation& observation, std::size_t index) {
    const auto begin = observation.begin() + static_cast<std::ptrdiff_t>(index * kPpoColumns);
    return {begin, begin + kPpoColumns};
  }
  static void expectNear(const std::vector<double>& found, const std::vector<double>& expected) {
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-5) << i;
  }

  map::RoadNetwork network_ =
      testing::makeNetwork({{"road", testing::straight(0.0, 15.0, 100.0, 15.0)}});
  map::Route route_ = testing::routeAlong(network_, {"road"});
  traffic::TrafficSnapshot snapshot_ = test::snapshotWithEgo(0, {10.0, 15.0, 0.0, 8.0});
};

// The CBV at (10, 5) looks north. The ego is 10 m ahead of it and turned by -90 degrees. Of the
// others (13, 5) is nearest, 3 m to its right; boxes are 4.5 x 1.8 m. The ego at arc length 10 has
// its goal 6.5 m ahead, at (16.5, 15): 10 m ahead of the CBV, 6.5 m to its right, sqrt(142.25) m
// away.
TEST_F(PpoRules, ObservationOfAHandMadeScene) {
  snapshot_.vehicles.push_back(test::vehicle("b", {13.0, 5.0, 90.0, 2.0}));
  snapshot_.vehicles.push_back(test::vehicle("a", {10.0, -20.0, 0.0, 1.0}));
  const double right = -core::kPi / 2.0;
  const PpoObservation found = observe(ppoGoal(route_, 10.0));
  expectNear(row(found, kPpoSelf), {0.0, 0.0, 4.5, 1.8, 0.0, 4.0});
  expectNear(row(found, kPpoEgo), {10.0, 0.0, 4.5, 1.8, right, 8.0});
  expectNear(row(found, kPpoNearest), {0.0, -3.0, 4.5, 1.8, 0.0, 2.0});
  expectNear(row(found, kPpoGoal), {10.0, -6.5, 4.0, 4.0, right, std::sqrt(142.25)});
}

TEST_F(PpoRules, NobodyWithinSixtyMetersOnTheLevelIsARowOfZeros) {
  snapshot_.vehicles.push_back(test::vehicle("far", {10.0, 65.5, 0.0, 1.0}));
  snapshot_.vehicles.push_back(test::vehicle("above", {12.0, 5.0, 0.0, 1.0, 6.0}));
  snapshot_.vehicles.push_back(test::vehicle("nowhere", {kNan, 5.0, 0.0, 1.0}));
  expectNear(row(observe(ppoGoal(route_, 10.0)), kPpoNearest), {0.0, 0.0, 0.0, 0.0, 0.0, 0.0});
  snapshot_.vehicles.push_back(test::vehicle("near", {10.0, 64.5, 90.0, 1.0}));
  expectNear(row(observe(ppoGoal(route_, 10.0)), kPpoNearest), {59.5, 0.0, 4.5, 1.8, 0.0, 1.0});
}

// The route is 100 m long: at 97 m the goal lies 3.5 m beyond its end, straight on.
TEST_F(PpoRules, GoalGoesOnBeyondTheEndOfTheRoute) {
  const PpoGoal goal = ppoGoal(route_, 97.0);
  EXPECT_NEAR(goal.position.x(), 103.5, 1e-9);
  EXPECT_NEAR(goal.position.y(), 15.0, 1e-9);
  EXPECT_NEAR(goal.heading, 0.0, 1e-9);
}

TEST_F(PpoRules, ValuesThatAreNotFiniteAreNamed) {
  EXPECT_EQ(ppoNotFinite(observe(ppoGoal(route_, 10.0))), "");
  snapshot_.vehicles[0].state.speed = kNan;
  EXPECT_EQ(ppoNotFinite(observe(ppoGoal(route_, 10.0))), "speed of the ego");
  snapshot_.vehicles[1].state.position.x() = kNan;
  EXPECT_EQ(ppoNotFinite(observe(ppoGoal(route_, 10.0))), "x of the CBV");
}

// a = 3 * 0.5 = 1.5 m/s^2: throttle 1.5 / 3; a = -3 * 0.8 = -2.4: brake 2.4 / 8; beyond 1 clipped
// to 3 m/s^2 and 0.3.
TEST_F(PpoRules, CommandsOfActions) {
  EXPECT_EQ(ppoCommand({0.5F, -0.5F}), (traffic::ControlAction{0.5, -0.15, 0.0}));
  EXPECT_NEAR(ppoCommand({-0.8F, 0.0F}).brake, 0.3, 1e-7);
  EXPECT_EQ(ppoCommand({-0.8F, 0.0F}).throttle, 0.0);
  EXPECT_EQ(ppoCommand({7.0F, 7.0F}), (traffic::ControlAction{1.0, 0.3, 0.0}));
  EXPECT_EQ(ppoCommand({-7.0F, -7.0F}), (traffic::ControlAction{0.0, -0.3, 0.375}));
  EXPECT_THROW(ppoCommand({std::nanf(""), 0.0F}), std::invalid_argument);
}

TEST_F(PpoRules, RewardOfWhatHappened) {
  EXPECT_DOUBLE_EQ(ppoReward({12.0, 11.75, false, false}), 0.25);
  EXPECT_DOUBLE_EQ(ppoReward({12.0, 10.5, false, false}), 1.0);   // 1.5 m, clipped
  EXPECT_DOUBLE_EQ(ppoReward({12.0, 14.0, false, false}), -1.0);  // away, clipped
  EXPECT_DOUBLE_EQ(ppoReward({4.5, 3.75, false, true}), 15.75);
  EXPECT_DOUBLE_EQ(ppoReward({12.0, 11.5, true, false}), -14.5);
  EXPECT_DOUBLE_EQ(ppoReward({4.5, 3.75, true, true}), 0.75);
}

}  // namespace
}  // namespace cdiff::planners
