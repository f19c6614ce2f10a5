// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/pacer_fixture.h"

namespace cdiff::node_graph {
namespace {

using msgs::TickAck;
using test::ackOf;
using Clock = SessionWatch::Clock;

class SessionWatchTest : public ::testing::Test {
 protected:
  SessionWatchTest() { test::initRos(); }

  StopSignal stop_;
  ParticipantTracker participants_{{kMetricsNode, kRecorderNode, kCameraNode}};
  Connections connections_;
  SessionWatch watch_{stop_, participants_, connections_};
};

TEST_F(SessionWatchTest, WaitsUntilNothingIsMissing) {
  int looks = 0;
  const auto missing = [&] {
    return looks < 2 ? std::vector<Missing>{{kCameraNode, "its image"}} : std::vector<Missing>{};
  };
  EXPECT_FALSE(watch_.waitFor(missing, 30.0, [&] { ++looks; }));
  EXPECT_EQ(looks, 2);
}

TEST_F(SessionWatchTest, BlamesTheNodeThatSaysNothing) {
  participants_.note(ackOf(kCameraNode, TickAck::ALIVE), Clock::now() - std::chrono::seconds(20));
  participants_.note(ackOf(kMetricsNode, TickAck::ALIVE));
  const auto end = watch_.waitFor(
      [] {
        return std::vector<Missing>{{kMetricsNode, "one thing"}, {kRecorderNode, "another"}};
      },
      0.1);
  ASSERT_TRUE(end);
  EXPECT_EQ(end->status, traffic::SessionStatus::kError);
  EXPECT_EQ(end->source, kCameraNode);
  EXPECT_EQ(end->text, "nothing came for 0.1 s: one thing; another");
}

TEST_F(SessionWatchTest, BlamesWhoOwesTheFirstThingWhereAllAreHeard) {
  for (const char* node : {kMetricsNode, kRecorderNode, kCameraNode})
    participants_.note(ackOf(node, TickAck::ALIVE));
  EXPECT_EQ(watch_.endOfPatience({{kRecorderNode, "one"}, {kMetricsNode, "two"}}, 30.0).source,
            kRecorderNode);
}

TEST_F(SessionWatchTest, ErrorDepartureAndOtherCausesEndAWaitAtOnce) {
  EXPECT_FALSE(watch_.disturbance());
  watch_.setOtherCause([] {
    return SessionEnd{traffic::SessionStatus::kError, "the external ego planner", "gone"};
  });
  EXPECT_EQ(watch_.disturbance()->source, "the external ego planner");
  connections_.expect("traffic", {kCameraNode});
  connections_.connected("traffic", "/" + std::string(kCameraNode));
  connections_.disconnected("traffic", "/" + std::string(kCameraNode));
  EXPECT_EQ(watch_.disturbance()->text, "the node left the session");
  TickAck error = ackOf(kRecorderNode, TickAck::ERROR);
  error.text = "no room";
  participants_.note(error);
  const auto end = watch_.waitFor([] { return std::vector<Missing>{{kMetricsNode, "all"}}; }, 30.0);
  ASSERT_TRUE(end);
  EXPECT_EQ(end->source, kRecorderNode);
  EXPECT_EQ(end->text, "no room");
}

TEST_F(SessionWatchTest, NamesWhoIsNotReadyAndWhoDoesNotListen) {
  participants_.note(ackOf(kMetricsNode, TickAck::READY));
  participants_.note(ackOf(kRecorderNode, TickAck::READY));
  connections_.expect("traffic", {kRecorderNode});
  const std::vector<Missing> missing = watch_.notReady();
  ASSERT_EQ(missing.size(), 2U);
  EXPECT_EQ(missing[0].what, std::string(kCameraNode) + " has not started");
  EXPECT_EQ(missing[0].node, kCameraNode);
  EXPECT_EQ(missing[1].node, kRecorderNode);
}

TEST_F(SessionWatchTest, WaitsForObserversThatWereHeardAndHaveNotFinished) {
  const auto wait = [this](double seconds) {
    const Clock::time_point begin = Clock::now();
    watch_.waitForObservers(seconds);
    return secondsSince(begin);
  };
  EXPECT_LT(wait(10.0), 5.0);  // none was heard
  participants_.note(ackOf(kMetricsNode, TickAck::ALIVE));
  EXPECT_GE(wait(0.2), 0.2);
  participants_.note(ackOf(kMetricsNode, TickAck::FINISHED));
  EXPECT_LT(wait(10.0), 5.0);
}

}  // namespace
}  // namespace cdiff::node_graph
