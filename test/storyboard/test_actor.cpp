// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// The motion of entities, on a straight road of two lanes along x: middles at y = -1.75 and -5.25.
#include <gtest/gtest.h>

#include "storyboard/actor.h"
#include "support/sumo_network.h"

namespace cdiff::storyboard {
namespace {

constexpr double kStep = 0.05;  // [s]

class StoryboardActor : public testing::Test {
 protected:
  StoryboardActor() {
    entity_.name = "car";
    entity_.center = {1.5, 0.0};
    actor_.place({{{10.0, -5.25}, 0.0}, 0.0});
  }
  void drive(double seconds) {
    for (int i = 0; i < static_cast<int>(std::lround(seconds / kStep)); ++i) {
      time_ += kStep;
      actor_.advance(time_, kStep);
    }
  }
  static Dynamics over(Dynamics::Shape shape, Dynamics::Dimension dimension, double value) {
    return {shape, dimension, value};
  }
  test::TemporaryFolder folder_;
  test::SumoNetwork net_ = test::makeSumoNetwork(
      folder_, R"(<node id="a" x="0" y="0"/><node id="b" x="500" y="0"/>)",
      R"(<edge id="e" from="a" to="b" numLanes="2" width="3.5" speed="20"/>)");
  map::LaneGraph graph_{net_.network};
  Places places_{graph_, std::nullopt};
  Entity entity_;
  Actor actor_{entity_, places_};
  double time_ = 0.0;
};

TEST_F(StoryboardActor, TheBoxLiesAheadOfTheReferencePoint) {
  EXPECT_NEAR(actor_.state().position.x(), 11.5, 1e-9);
  EXPECT_NEAR(actor_.state().position.y(), -5.25, 1e-9);
}

TEST_F(StoryboardActor, SpeedChangesAtItsRate) {
  const auto performing = std::make_shared<Performance>();
  actor_.setSpeed(over(Dynamics::Shape::kLinear, Dynamics::Dimension::kRate, 2.0), 8.0, performing);
  drive(2.0);
  EXPECT_NEAR(actor_.speed(), 4.0, 1e-9);                         // 2 s at 2 m/s^2
  EXPECT_NEAR(actor_.reference().pose.position.x(), 14.0, 1e-9);  // 10 + 0.5 * 2 * 2^2
  EXPECT_FALSE(performing->over);
  drive(2.0);
  EXPECT_NEAR(actor_.speed(), 8.0, 1e-9);
  EXPECT_TRUE(performing->over);
}

TEST_F(StoryboardActor, ALaneChangeIsHalfDoneInHalfItsTime) {
  actor_.setSpeed({}, 10.0, std::make_shared<Performance>());
  const auto performing = std::make_shared<Performance>();
  actor_.changeLane(over(Dynamics::Shape::kSinusoidal, Dynamics::Dimension::kTime, 4.0),
                    {10.0, -1.75}, {10.0, -1.75}, performing);
  drive(2.0);
  EXPECT_NEAR(actor_.reference().pose.position.y(), -3.5, 1e-6);
  EXPECT_GT(actor_.reference().pose.heading, 0.05);
  drive(2.0);
  EXPECT_NEAR(actor_.reference().pose.position.y(), -1.75, 1e-6);
  EXPECT_NEAR(actor_.reference().pose.position.x(), 50.0, 1e-6);
  EXPECT_TRUE(performing->over);
  drive(1.0);
  EXPECT_NEAR(actor_.reference().pose.heading, 0.0, 1e-6);
}

// A rate is the largest one of a change: of a cosine over 3.5 m at 1.75 m/s after pi / 2 * 2 s.
TEST_F(StoryboardActor, ARateIsTheLargestOfAChange) {
  actor_.setSpeed({}, 10.0, std::make_shared<Performance>());
  const auto performing = std::make_shared<Performance>();
  actor_.changeLane(over(Dynamics::Shape::kSinusoidal, Dynamics::Dimension::kRate, 1.75),
                    {10.0, -1.75}, {10.0, -1.75}, performing);
  drive(3.1);
  EXPECT_FALSE(performing->over);
  drive(0.1);
  EXPECT_TRUE(performing->over);
}

// The curvature of a cosine over 1.5 m in T is 1.5 / 2 * (pi / T)^2: for 0.3 m/s^2, T = 4.97 s.
TEST_F(StoryboardActor, AnOffsetTakesTheTimeOfItsLargestAcceleration) {
  actor_.setSpeed({}, 10.0, std::make_shared<Performance>());
  const auto performing = std::make_shared<Performance>();
  actor_.setOffset(over(Dynamics::Shape::kSinusoidal, Dynamics::Dimension::kAcceleration, 0.3), 1.5,
                   false, performing);
  drive(4.9);
  EXPECT_FALSE(performing->over);
  drive(0.1);
  EXPECT_TRUE(performing->over);
}

TEST_F(StoryboardActor, AStepThatLastsTakesEffectAtOnce) {
  const auto performing = std::make_shared<Performance>();
  actor_.setSpeed(over(Dynamics::Shape::kStep, Dynamics::Dimension::kDistance, 3.0), 2.0,
                  performing);
  EXPECT_EQ(actor_.speed(), 2.0);
  drive(1.4);
  EXPECT_FALSE(performing->over);
  drive(0.1);
  EXPECT_TRUE(performing->over);  // 3 m at 2 m/s
}

TEST_F(StoryboardActor, AChangeAtOnceTurnsNobody) {
  actor_.setSpeed({}, 10.0, std::make_shared<Performance>());
  actor_.setOffset(over(Dynamics::Shape::kStep, Dynamics::Dimension::kTime, 0.0), 1.0, false,
                   std::make_shared<Performance>());
  drive(kStep);
  EXPECT_NEAR(actor_.reference().pose.position.y(), -4.25, 1e-9);
  EXPECT_EQ(actor_.reference().pose.heading, 0.0);
}

TEST_F(StoryboardActor, AnOffsetThatIsKeptDoesNotEnd) {
  const auto performing = std::make_shared<Performance>();
  actor_.setOffset(over(Dynamics::Shape::kStep, Dynamics::Dimension::kTime, 0.0), 1.0, true,
                   performing);
  drive(1.0);
  EXPECT_FALSE(performing->over);
  EXPECT_NEAR(actor_.reference().pose.position.y(), -4.25, 1e-9);
  performing->stopped = true;
  drive(kStep);
  EXPECT_TRUE(performing->over);
}

TEST_F(StoryboardActor, TheWayToATimedTrajectoryIsNoSpeed) {
  actor_.follow({{{{110.0, -5.25}, 0.0}, 0.0}, {{{120.0, -5.25}, 0.0}, 0.0}}, {0.0, 2.0},
                std::make_shared<Performance>());
  drive(kStep);
  EXPECT_NEAR(actor_.speed(), 5.0, 1e-9);
  drive(kStep);
  EXPECT_NEAR(actor_.speed(), 5.0, 1e-9);
}

TEST_F(StoryboardActor, ATimedTrajectoryIsMetAtItsTimes) {
  const auto performing = std::make_shared<Performance>();
  actor_.follow({{{{10.0, -5.25}, 0.0}, 0.0}, {{{20.0, -4.0}, 0.2}, 0.0}}, {0.0, 2.0}, performing);
  drive(1.0);
  EXPECT_NEAR(actor_.reference().pose.position.x(), 15.0, 1e-9);
  EXPECT_NEAR(actor_.reference().pose.heading, 0.1, 1e-9);
  drive(1.0);
  EXPECT_NEAR(actor_.reference().pose.position.y(), -4.0, 1e-9);
  EXPECT_TRUE(performing->over);
}

TEST_F(StoryboardActor, AnotherActionOfTheSameKindEndsTheOneBefore) {
  const auto first = std::make_shared<Performance>();
  actor_.setSpeed(over(Dynamics::Shape::kLinear, Dynamics::Dimension::kTime, 10.0), 8.0, first);
  drive(1.0);
  actor_.setSpeed({}, 3.0, std::make_shared<Performance>());
  EXPECT_TRUE(first->over);
  EXPECT_EQ(actor_.speed(), 3.0);
}

TEST_F(StoryboardActor, AStoppedActionKeepsTheSpeedReached) {
  const auto performing = std::make_shared<Performance>();
  actor_.setSpeed(over(Dynamics::Shape::kLinear, Dynamics::Dimension::kRate, 2.0), 8.0, performing);
  drive(1.0);
  performing->stopped = true;
  drive(1.0);
  EXPECT_NEAR(actor_.speed(), 2.0, 1e-9);
}

TEST_F(StoryboardActor, ATimedTrajectoryThatEndsWithinAStepLeavesItsOwnSpeed) {
  actor_.follow({{{{10.0, -5.25}, 0.0}, 0.0}, {{{30.1, -5.25}, 0.0}, 0.0}}, {0.0, 2.01},
                std::make_shared<Performance>());
  drive(3.0);
  EXPECT_NEAR(actor_.speed(), 10.0, 1e-9);
}

TEST_F(StoryboardActor, ALaneChangeEndsATrajectory) {
  actor_.setSpeed({}, 10.0, std::make_shared<Performance>());
  const auto course = std::make_shared<Performance>();
  actor_.follow({{{{10.0, -5.25}, 0.0}, 0.0}, {{{400.0, -5.25}, 0.0}, 0.0}}, {}, course);
  drive(1.0);
  actor_.changeLane(over(Dynamics::Shape::kLinear, Dynamics::Dimension::kTime, 2.0), {20.0, -1.75},
                    {20.0, -1.75}, std::make_shared<Performance>());
  EXPECT_TRUE(course->over);
  drive(3.0);
  EXPECT_NEAR(actor_.reference().pose.position.y(), -1.75, 1e-6);
}

TEST_F(StoryboardActor, ASpeedActionEndsATrajectoryWithTimes) {
  const auto course = std::make_shared<Performance>();
  actor_.follow({{{{10.0, -5.25}, 0.0}, 0.0}, {{{400.0, -5.25}, 0.0}, 0.0}}, {0.0, 10.0}, course);
  drive(1.0);
  actor_.setSpeed({}, 5.0, std::make_shared<Performance>());
  EXPECT_TRUE(course->over);
  drive(1.0);
  EXPECT_NEAR(actor_.reference().pose.position.x(), 54.0, 1e-6);  // 39 m in 1 s, then 5 m
}

TEST_F(StoryboardActor, AfterAPlannerItKeepsThePlannersSpeed) {
  const auto performing = std::make_shared<Performance>();
  actor_.setSpeed(over(Dynamics::Shape::kLinear, Dynamics::Dimension::kRate, 1.0), 20.0,
                  performing);
  actor_.leave();
  EXPECT_TRUE(performing->over);
  traffic::VehicleState state = actor_.state();
  state.speed = 7.0;
  actor_.resume(state);
  drive(1.0);
  EXPECT_EQ(actor_.speed(), 7.0);
}

TEST_F(StoryboardActor, ItDrivesOnBeyondTheLongestRoute) {
  test::TemporaryFolder folder;
  const test::SumoNetwork net = test::makeSumoNetwork(
      folder,
      R"(<node id="a" x="0" y="0"/><node id="b" x="1500" y="0"/><node id="c" x="3000" y="0"/>
<node id="d" x="4500" y="0"/>)",
      R"(<edge id="e" from="a" to="b" numLanes="1" speed="50"/>
<edge id="f" from="b" to="c" numLanes="1" speed="50"/>
<edge id="g" from="c" to="d" numLanes="1" speed="50"/>)");
  const map::LaneGraph graph(net.network);
  const Places places(graph, std::nullopt);
  Actor actor(entity_, places);
  actor.place({{{10.0, -1.6}, 0.0}, 0.0});
  actor.setSpeed({}, 100.0, std::make_shared<Performance>());
  for (int i = 0; i < 400; ++i) actor.advance(kStep * i, kStep * 2.0);
  EXPECT_NEAR(actor.reference().pose.position.x(), 4010.0, 1.0);
}

TEST_F(StoryboardActor, ItStopsWhereTheNetworkEnds) {
  actor_.setSpeed({}, 50.0, std::make_shared<Performance>());
  drive(20.0);
  EXPECT_NEAR(actor_.reference().pose.position.x(), 500.0, 1.0);
  EXPECT_EQ(actor_.speed(), 0.0);
}

}  // namespace
}  // namespace cdiff::storyboard
