// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <limits>

#include "e2e_cdiff/AckermannCommand.h"
#include "geometry_msgs/Twist.h"
#include "nav_msgs/Path.h"
#include "node_graph/messages/traffic_conversions.h"
#include "node_graph/nodes/external_ego.h"
#include "record/sample_session.h"

namespace cdiff::node_graph {
namespace {

/// The sample session, whose ego drives east at 8 m/s, at tick 4.
class ExternalEgoTest : public ::testing::Test {
 protected:
  ExternalEgo& commandedBy(const std::string& command, bool paced = false) {
    graph_.external_ego = true;
    graph_.ego_command = command;
    graph_.paced = paced;
    ego_.emplace(sample_.setup, graph_);
    publish(4);
    return *ego_;
  }
  void publish(std::uint64_t tick) { ego_->published(test::sampleSnapshot(tick)); }
  static msgs::ControlAction controlIn(const EgoAnswer& answer) {
    return answer.control ? *messageAs<msgs::ControlAction>(answer.control) : msgs::ControlAction();
  }
  static void expectFullBrake(const msgs::ControlAction& control, const std::string& fault) {
    EXPECT_EQ(control.throttle, 0.0);
    EXPECT_EQ(control.steer, 0.0);
    EXPECT_EQ(control.brake, 1.0);
    EXPECT_NE(control.fault.find(fault), std::string::npos) << control.fault;
  }

  test::SampleSetup sample_;
  SessionGraph graph_;
  std::optional<ExternalEgo> ego_;
};

msgs::AckermannCommand ackermann(std::uint64_t tick, double speed, double angle) {
  msgs::AckermannCommand command;
  command.tick = tick;
  command.speed = speed;
  command.steering_angle = angle;
  return command;
}

/// Six poses on the ego's route, `period` [s] apart.
nav_msgs::Path trajectory(double begin, const std::string& frame = "map", double period = 0.5) {
  nav_msgs::Path path;
  path.header.frame_id = frame;
  path.header.stamp = toStamp(0.2);
  for (int i = 1; i <= 6; ++i) {
    path.poses.emplace_back();
    path.poses.back().header.stamp = toStamp(begin + period * i);
    path.poses.back().pose.position.x = 5.0 + 8.0 * (begin + period * i);
    path.poses.back().pose.position.y = -2.0;
  }
  return path;
}

TEST_F(ExternalEgoTest, EachCommandHasItsTopic) {
  EXPECT_EQ(commandedBy("control").topic().name(), "ego/control");
  EXPECT_EQ(commandedBy("ackermann").topic().name(), "ego/ackermann");
  EXPECT_EQ(commandedBy("trajectory").topic().name(), "ego/trajectory");
  EXPECT_EQ(commandedBy("cmd_vel").topic().name(), "ego/cmd_vel");
  graph_.external_ego = false;
  EXPECT_EQ(egoCommandOf(graph_), Topic(ChannelId::kEgoControl)) << "of planners of ours";
}

TEST_F(ExternalEgoTest, AckermannBecomesTheControlOfItsTick) {
  const auto control =
      controlIn(commandedBy("ackermann").take(shared(ackermann(4, 8.0, 0.18424168))));
  EXPECT_EQ(control.tick, 4U);
  EXPECT_EQ(control.slot, kEgoSlot);
  EXPECT_NEAR(control.steer, 0.5, 1e-9);
  EXPECT_EQ(control.brake, 0.0);
  EXPECT_EQ(control.fault, "");
  EXPECT_GT(control.planner_latency_ms, 0.0);
}

TEST_F(ExternalEgoTest, ItsLatencyIsWhatItSaysWhereItSaysSo) {
  msgs::ControlAction said;
  said.tick = 4;
  said.planner_latency_ms = 12.5;
  EXPECT_EQ(controlIn(commandedBy("control").take(shared(said))).planner_latency_ms, 12.5);
  said.planner_latency_ms = std::numeric_limits<double>::quiet_NaN();
  const double measured = controlIn(ego_->take(shared(said))).planner_latency_ms;
  EXPECT_GT(measured, 0.0);
  EXPECT_LT(measured, 60e3);
}

TEST_F(ExternalEgoTest, AStampStandsForTheTick) {
  msgs::AckermannCommand command = ackermann(0, 8.0, 0.0);
  command.header.stamp = toStamp(0.2);
  EXPECT_EQ(controlIn(commandedBy("ackermann").take(shared(command))).tick, 4U);
}

TEST_F(ExternalEgoTest, ACommandWithoutTickIsNamedAsThat) {
  for (const char* way : {"control", "ackermann"}) {
    ExternalEgo& ego = commandedBy(way);
    const EgoAnswer answer = std::string(way) == "control"
                                 ? ego.take(shared(msgs::ControlAction()))
                                 : ego.take(shared(ackermann(0, 8.0, 0.0)));
    EXPECT_EQ(answer.control, nullptr);
    EXPECT_NE(answer.refused.find("neither tick nor stamp"), std::string::npos) << answer.refused;
  }
  EXPECT_EQ(controlIn(commandedBy("control", true).take(shared(msgs::ControlAction()))).tick, 4U)
      << "where the wall clock rules it is of the newest tick";
  commandedBy("control");
  ego_.emplace(sample_.setup, graph_);
  publish(0);
  EXPECT_NE(ego_->take(shared(msgs::ControlAction())).control, nullptr) << "it is tick 0";
}

TEST_F(ExternalEgoTest, AnswersToTicksThatHaveNotBeenAreRefused) {
  const EgoAnswer answer = commandedBy("ackermann").take(shared(ackermann(6, 8.0, 0.0)));
  EXPECT_EQ(answer.control, nullptr);
  EXPECT_NE(answer.refused.find("tick 6, which has not been"), std::string::npos);
}

TEST_F(ExternalEgoTest, WhatTheVehicleCannotFollowBecomesFullBrakingWithAFault) {
  expectFullBrake(controlIn(commandedBy("ackermann").take(shared(ackermann(4, 8.0, 0.5)))),
                  "ego/ackermann: steering_angle is 0.5 rad; the vehicle's largest is");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expectFullBrake(controlIn(commandedBy("ackermann").take(shared(ackermann(4, nan, 0.0)))),
                  "speed is nan");
  msgs::AckermannCommand unknown = ackermann(4, 8.0, 0.0);
  unknown.drive_by = 2;
  expectFullBrake(controlIn(commandedBy("ackermann").take(shared(unknown))), "drive_by is 2");
  expectFullBrake(controlIn(commandedBy("trajectory").take(shared(trajectory(0.0, "map", 0.03)))),
                  "lies in the past");
  expectFullBrake(controlIn(commandedBy("trajectory").take(shared(trajectory(0.2, "odom")))),
                  "frame is 'odom'; expected 'map'");
  geometry_msgs::Twist sideways;
  sideways.linear.x = 5.0;
  sideways.linear.y = 0.5;
  expectFullBrake(controlIn(commandedBy("cmd_vel").take(shared(sideways))), "linear.y is 0.5");
}

TEST_F(ExternalEgoTest, ATrajectoryIsFollowed) {
  const auto control = controlIn(commandedBy("trajectory").take(shared(trajectory(0.2))));
  EXPECT_EQ(control.fault, "");
  EXPECT_EQ(control.tick, 4U);
  EXPECT_EQ(control.brake, 0.0);
  EXPECT_NEAR(control.steer, 0.0, 1e-6);
}

TEST_F(ExternalEgoTest, OfACommandForTheSameTickTheFirstCounts) {
  ExternalEgo& ego = commandedBy("ackermann");
  EXPECT_NE(ego.take(shared(ackermann(4, 8.0, 0.0))).control, nullptr);
  const EgoAnswer second = ego.take(shared(ackermann(4, 0.0, 0.0)));
  EXPECT_EQ(second.control, nullptr);
  EXPECT_EQ(second.refused, "");
}

TEST_F(ExternalEgoTest, AVelocityAnswersTheDecisionThatIsOut) {
  geometry_msgs::Twist twist;
  twist.linear.x = 8.0;
  EXPECT_EQ(controlIn(commandedBy("cmd_vel").take(shared(twist))).tick, 4U);
  publish(5);  // no decision
  EXPECT_EQ(ego_->take(shared(twist)).control, nullptr);
  publish(6);
  EXPECT_EQ(controlIn(ego_->take(shared(twist))).tick, 6U);
}

}  // namespace
}  // namespace cdiff::node_graph
