// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/planning/challenge.h"

namespace cdiff::planning {
namespace {

constexpr double kNorth = 0.5 * core::kPi;

/// An ego that keeps its speed along a straight road, x = 100 m at the start; one CBV.
class ChallengeTest : public ::testing::Test {
 protected:
  ChallengeTest() {
    std::vector<Eigen::Vector3d> points;
    for (int x = 0; x <= 400; ++x) points.push_back({1.0 * x, 0.0, 0.0});
    route_ = map::Route(network_, points, std::vector<map::LaneIndex>(points.size(), 0));
  }

  static traffic::Vehicle vehicleAt(const std::string& id, const Eigen::Vector2d& place,
                                    double heading, double speed) {
    traffic::Vehicle vehicle;
    vehicle.id = id;
    vehicle.role = id == "ego" ? traffic::VehicleRole::kEgo : traffic::VehicleRole::kCbv;
    vehicle.cbv_slot = id == "ego" ? -1 : 0;
    vehicle.state.position = place;
    vehicle.state.heading = heading;
    vehicle.state.speed = speed;
    return vehicle;
  }
  /// Keeps its speed and heading, or brakes.
  static ChallengePlan planOf(const traffic::Vehicle& cbv, double braking = 0.0) {
    ChallengePlan plan;
    traffic::VehicleState state = cbv.state;
    for (int row = 0; row < 32; ++row) {
      const double next = std::max(0.0, state.speed - 0.1 * braking);
      state.position += 0.05 * (state.speed + next) * geometry::direction(state.heading);
      state.speed = next;
      plan.states.push_back(state);
    }
    plan.brakes = braking > 0.0;
    return plan;
  }
  /// Going on and braking, at time 0.
  guidance::ChallengeReport decide(Challenge& challenge, const traffic::Vehicle& cbv,
                                   double ego_speed = 8.0) const {
    traffic::TrafficSnapshot snapshot;
    snapshot.vehicles = {vehicleAt("ego", {100.0, 0.0}, 0.0, ego_speed), cbv};
    challenge.startDecision(snapshot);
    return challenge.choose(cbv, {planOf(cbv), planOf(cbv, 6.0)});
  }

  map::RoadNetwork network_ = map::RoadNetwork::fromText(
      R"(<net><edge id="road"><lane id="road_0" index="0" speed="13.9" shape="0,0 400,0"/></edge></net>)",
      "road");
  map::DrivableArea area_{network_};
  map::Route route_;
  PlanningContext context_{network_, area_, 1, 0.05, 0.1, &route_};
  /// From the right at 10 m/s: in the corridor from 2.49 s to 3.27 s, when the front of an ego at 8
  /// m/s reaches it. It cannot yield any more (100 / 2 x 24.85 > 2 m/s^2), so C brakes 1.2 s from
  /// now and stands in time.
  traffic::Vehicle crossing_ = vehicleAt("cbv", {124.0, -28.0}, kNorth, 10.0);
  /// The same from 8 m at 5 m/s: there is no time for C.
  traffic::Vehicle jumping_ = vehicleAt("cbv", {114.0, -8.0}, kNorth, 5.0);
};

TEST_F(ChallengeTest, AttacksWhereACarefulDriverCanAnswer) {
  Challenge challenge(context_, "medium");
  const guidance::ChallengeReport report = decide(challenge, crossing_);
  EXPECT_EQ(report.state, "attacks");
  EXPECT_EQ(report.chosen, 0);
  EXPECT_EQ(report.refusals, std::vector<std::string>(2));
  EXPECT_GE(report.delta, 0.3);
  EXPECT_LT(report.delta, 1.0);
  ASSERT_TRUE(report.ghost.has_value());
  EXPECT_NEAR(report.ghost->position.x(), 100.0, 1e-9);
  ASSERT_TRUE(report.last_brake_time.has_value());
  EXPECT_NEAR(*report.last_brake_time, 1.2 + report.delta, 1e-9);
}

// 20.5 m ahead and 3 m/s slower: the ego reaches it in 6.8 s.
TEST_F(ChallengeTest, PrefersAnApproachThatLeadsToAHitAfterThePlan) {
  const traffic::Vehicle lead = vehicleAt("cbv", {125.0, 0.0}, 0.0, 5.0);
  traffic::Vehicle leaving = lead;
  leaving.state.speed = 9.0;
  ChallengePlan approach = planOf(lead);
  approach.score = 1.0;  // the worse one by its objective
  traffic::TrafficSnapshot snapshot;
  snapshot.vehicles = {vehicleAt("ego", {100.0, 0.0}, 0.0, 8.0), lead};
  Challenge challenge(context_, "medium");
  challenge.startDecision(snapshot);
  const auto report = challenge.choose(lead, {planOf(leaving), approach});
  EXPECT_EQ(report.chosen, 1);
  EXPECT_EQ(report.state, "drives");
  EXPECT_FALSE(report.ghost.has_value());
}

TEST_F(ChallengeTest, TakesAPlanThatIsLongerThanAnApproach) {
  const traffic::Vehicle far = vehicleAt("cbv", {160.0, 60.0}, 0.0, 5.0);
  ChallengePlan plan = planOf(far);
  plan.states.insert(plan.states.end(), 100, plan.states.back());
  traffic::TrafficSnapshot snapshot;
  snapshot.vehicles = {vehicleAt("ego", {100.0, 0.0}, 0.0, 8.0), far};
  Challenge challenge(context_, "medium");
  challenge.startDecision(snapshot);
  const auto report = challenge.choose(far, {plan});
  EXPECT_EQ(report.state, "drives");
  EXPECT_EQ(report.refusals, std::vector<std::string>(1));
}

TEST_F(ChallengeTest, AsksForMoreTimeAtAnEasierLevel) {
  Challenge hard(context_, "hard");
  const double delta = decide(hard, crossing_).delta;
  traffic::Vehicle nearer = crossing_;  // the ego strikes it sooner
  nearer.state.position.x() = 121.4;
  Challenge again(context_, "hard");
  EXPECT_LT(decide(again, nearer).delta, delta);
  Challenge easy(context_, "easy");
  const guidance::ChallengeReport report = decide(easy, nearer);
  EXPECT_EQ(report.refusals[0], "it leaves a careful driver too little time");
  EXPECT_EQ(report.chosen, 1);
}

TEST_F(ChallengeTest, RefusesWhatACarefulDriverCannotAnswer) {
  Challenge challenge(context_, "hard");
  const guidance::ChallengeReport report = decide(challenge, jumping_);
  EXPECT_EQ(report.refusals[0], "a careful driver in the ego's place cannot answer it");
  EXPECT_EQ(report.chosen, 1);
  EXPECT_EQ(report.state, "drives");
  EXPECT_FALSE(report.ghost.has_value());
}

TEST_F(ChallengeTest, NeverStrikesFromBehindOrAStandingEgo) {
  Challenge challenge(context_, "hard");
  const auto behind = decide(challenge, vehicleAt("cbv", {85.0, 0.0}, 0.0, 14.0));
  EXPECT_EQ(behind.refusals[0], "from behind");
  Challenge other(context_, "hard");
  const auto standing = decide(other, vehicleAt("cbv", {101.0, -25.0}, kNorth, 10.0), 0.0);
  EXPECT_EQ(standing.refusals[0], "the ego stands");
  EXPECT_FALSE(standing.ghost.has_value());
}

TEST_F(ChallengeTest, RefusesAPlanThatIsNotFinite) {
  Challenge challenge(context_, "hard");
  traffic::TrafficSnapshot snapshot;
  snapshot.vehicles = {vehicleAt("ego", {100.0, 0.0}, 0.0, 8.0), crossing_};
  challenge.startDecision(snapshot);
  ChallengePlan lost = planOf(crossing_);
  lost.states[5].position.x() = std::numeric_limits<double>::quiet_NaN();
  const auto report = challenge.choose(crossing_, {lost, planOf(crossing_, 6.0)});
  EXPECT_EQ(report.refusals[0], "it is not finite");
  EXPECT_EQ(report.chosen, 1);
}

// The ego does not react: soon C in its place could no longer answer, but the ghost has braked.
TEST_F(ChallengeTest, KeepsItsPromiseThoughTheEgoDoesNotReact) {
  Challenge challenge(context_, "medium");
  traffic::TrafficSnapshot snapshot;
  snapshot.vehicles = {vehicleAt("ego", {100.0, 0.0}, 0.0, 8.0), crossing_};
  traffic::Vehicle& ego = snapshot.vehicles[0];
  traffic::Vehicle& cbv = snapshot.vehicles[1];
  ChallengePlan promised = planOf(cbv);
  bool unanswerable = false;
  for (int decision = 0; decision < 27; ++decision) {
    snapshot.tick = static_cast<std::uint64_t>(2 * decision);
    snapshot.time = 0.1 * decision;
    challenge.startDecision(snapshot);
    promised.kept = decision > 0;
    const auto report = challenge.choose(cbv, {promised, planOf(cbv, 6.0)});
    ASSERT_EQ(report.chosen, 0) << decision << ": " << report.refusals[0];
    ASSERT_EQ(report.state, "attacks") << decision << ": " << report.reason;
    Challenge fresh(context_, "medium");  // which made no promise
    fresh.startDecision(snapshot);
    unanswerable =
        unanswerable || !fresh.choose(cbv, {planOf(cbv), planOf(cbv, 6.0)}).refusals[0].empty();
    ego.state.position += 0.1 * ego.state.velocity();
    cbv.state.position += 0.1 * cbv.state.velocity();
    promised = planOf(cbv);
  }
  EXPECT_TRUE(unanswerable);
  EXPECT_TRUE(geometry::overlap(ego.box(), cbv.box()));
}

TEST_F(ChallengeTest, RefusesAnUnknownLevel) {
  try {
    Challenge challenge(context_, "mediun");
    FAIL();
  } catch (const core::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean 'medium'"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace cdiff::planning
