// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>

#include "node_graph/lockstep/message_gate.h"
#include "node_graph/lockstep/participant_tracker.h"
#include "node_graph/lockstep/tick_answers.h"
#include "node_graph/messages/channel_conversions.h"
#include "node_graph/messages/session_conversions.h"
#include "node_graph/messages/topics.h"
#include "node_graph/messages/traffic_conversions.h"
#include "node_graph/sample_messages.h"
#include "node_graph/session_graph.h"

namespace cdiff::node_graph {
namespace {

using Texts = std::vector<std::string>;
using test::controlFor;
using test::selectionFor;

TEST(TickAnswers, NothingIsMissingBetweenDecisions) {
  msgs::TrafficSnapshot snapshot = toMsg(test::sampleSnapshot(3));
  snapshot.decision_tick = false;
  EXPECT_EQ(namesOf(TickAnswers().missing(snapshot)), Texts());
}

TEST(TickAnswers, WhatIsMissingDependsOnTheSelection) {
  const msgs::TrafficSnapshot snapshot = toMsg(test::sampleSnapshot(4));
  TickAnswers answers;
  EXPECT_EQ(namesOf(answers.missing(snapshot)), (Texts{"ego/control", "cbv/selection"}));
  answers.add(ChannelId::kSelection, selectionFor(4, 1, "bg_7"));
  EXPECT_EQ(namesOf(answers.missing(snapshot)), (Texts{"ego/control", "cbv_1/control"}));
  answers.add({ChannelId::kCbvControl, 1}, controlFor(2, 1, "bg_7"));  // of another tick
  EXPECT_EQ(namesOf(answers.missing(snapshot)), (Texts{"ego/control", "cbv_1/control"}));
  answers.add({ChannelId::kCbvControl, 1}, controlFor(4, 1, "bg_7"));
  answers.add(ChannelId::kEgoControl, controlFor(4, -1, "ego"));
  EXPECT_EQ(namesOf(answers.missing(snapshot)), Texts());
}

TEST(TickAnswers, GuidanceIsWaitedForWhereItIsExpected) {
  const ChannelSet guidance = {ChannelId::kSelection, ChannelId::kEgoControl,
                               ChannelId::kCbvControl, ChannelId::kGuidance};
  const msgs::TrafficSnapshot snapshot = toMsg(test::sampleSnapshot(4));
  TickAnswers answers(0.05, guidance);
  answers.add(ChannelId::kEgoControl, controlFor(4, -1, "ego"));
  answers.add(ChannelId::kSelection, selectionFor(4, 1, "bg_gone"));
  EXPECT_EQ(namesOf(answers.missing(snapshot)), Texts());  // no one to drive
  answers = TickAnswers(0.05, guidance);
  answers.add(ChannelId::kEgoControl, controlFor(4, -1, "ego"));
  answers.add(ChannelId::kSelection, selectionFor(4, 1, "bg_7"));
  answers.add({ChannelId::kCbvControl, 1}, controlFor(4, 1, "bg_7"));
  EXPECT_EQ(namesOf(answers.missing(snapshot)), Texts{"cbv/guidance"});
  planning::PlannedAction action;
  action.vehicle_id = "bg_7";
  action.state_mismatch = 0.25;
  action.guidance.candidates = 3;
  answers.add(ChannelId::kGuidance, shared(toGuidanceMsg({action}, test::sampleSnapshot(4))));
  EXPECT_EQ(namesOf(answers.missing(snapshot)), Texts());
  const std::vector<Answer> all = answers.answers(snapshot);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].action.guidance.candidates, 0);
  EXPECT_EQ(all[1].action.guidance.candidates, 3);
  EXPECT_EQ(all[1].action.state_mismatch, 0.25);
}

sensor_msgs::Image::Ptr imageFor(std::uint64_t tick, const std::string& vehicle_id) {
  const traffic::CameraImage image{2, 1, tick, {1, 2, 3, 4, 5, 6}};
  return boost::make_shared<sensor_msgs::Image>(
      toMsg(image, 0.05 * static_cast<double>(tick), vehicle_id));
}

rendering::CameraOptions smallCamera() {
  rendering::CameraOptions camera;
  camera.width = 2;
  camera.height = 1;
  return camera;
}

TEST(TickAnswers, RolloutsAndImagesAreWaitedForWhereTheyAreExpected) {
  const traffic::TrafficSnapshot snapshot = test::sampleSnapshot(4);
  const msgs::TrafficSnapshot message = toMsg(snapshot);
  SessionGraph seeing{{kCameraNode}, 2};
  seeing.ego_sees = seeing.cbvs_see = true;
  TickAnswers answers(0.05, awaitedBy(Party::kMetrics, seeing),
                      session::VehicleRigs::front(smallCamera()));
  answers.add(ChannelId::kSelection, selectionFor(4, 1, "bg_7"));
  answers.add(ChannelId::kEgoControl, controlFor(4, -1, "ego"));
  answers.add({ChannelId::kCbvControl, 1}, controlFor(4, 1, "bg_7"));
  EXPECT_EQ(namesOf(answers.missing(message)),
            (Texts{"ego/camera/image_raw", "cbv_1/rollout", "cbv_1/camera/image_raw"}));
  planning::PlannedAction action;
  action.slot = 1;
  action.vehicle_id = "bg_7";
  action.rollout = {{{{1.0, 2.0}, 3.0, 0.5, 6.0}, {0.1, 0.2, 0.0}}};
  answers.add({ChannelId::kCbvRollout, 1},
              boost::make_shared<const msgs::Rollout>(toRolloutMsg(action, snapshot)));
  answers.add(ChannelId::kEgoImage, imageFor(4, "ego"));
  EXPECT_EQ(namesOf(answers.missing(message)), Texts{"cbv_1/camera/image_raw"});
  answers.add({ChannelId::kCbvImage, 1}, imageFor(4, "bg_7"));
  EXPECT_EQ(namesOf(answers.missing(message)), Texts());
  const std::vector<Answer> all = answers.answers(message);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_TRUE(all[0].action.rollout.empty());
  ASSERT_EQ(all[1].action.rollout.size(), 1U);
  EXPECT_EQ(all[1].action.rollout[0].state.speed, 6.0);
  const std::vector<session::SlotImage> seen = imagesOf(answers.answers(message));
  ASSERT_EQ(seen.size(), 2U);
  EXPECT_EQ(seen[0].slot, -1);
  EXPECT_EQ(seen[1].slot, 1);
  EXPECT_EQ(seen[1].image.tick, 4U);
  EXPECT_EQ(seen[1].image.rgb, (std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6}));
}

TEST(TickAnswers, ImageOfAnotherVehicleIsHereButNotSeen) {
  const msgs::TrafficSnapshot snapshot = toMsg(test::sampleSnapshot(4));
  TickAnswers answers(
      0.05,
      {ChannelId::kSelection, ChannelId::kEgoControl, ChannelId::kCbvControl, ChannelId::kCbvImage},
      session::VehicleRigs::front(smallCamera()));
  answers.add(ChannelId::kSelection, selectionFor(4, 1, "bg_7"));
  answers.add(ChannelId::kEgoControl, controlFor(4, -1, "ego"));
  answers.add({ChannelId::kCbvControl, 1}, controlFor(4, 1, "bg_7"));
  answers.add({ChannelId::kCbvImage, 1}, imageFor(4, "bg_9"));
  EXPECT_EQ(namesOf(answers.missing(snapshot)), Texts());
  EXPECT_TRUE(imagesOf(answers.answers(snapshot)).empty());
}

TEST(TickAnswers, AssignedVehicleThatIsGoneIsNotWaitedFor) {
  const msgs::TrafficSnapshot snapshot = toMsg(test::sampleSnapshot(4));
  TickAnswers answers;
  answers.add(ChannelId::kEgoControl, controlFor(4, -1, "ego"));
  answers.add(ChannelId::kSelection, selectionFor(4, 1, "bg_gone"));
  EXPECT_EQ(namesOf(answers.missing(snapshot)), Texts());
}

TEST(TickAnswers, EgoComesFirstWhateverTheOrderOfArrival) {
  const msgs::TrafficSnapshot snapshot = toMsg(test::sampleSnapshot(4));
  TickAnswers answers;
  answers.add({ChannelId::kCbvControl, 1}, controlFor(4, 1, "bg_7"));
  answers.add(ChannelId::kSelection, selectionFor(4, 1, "bg_7"));
  answers.add(ChannelId::kEgoControl, controlFor(4, -1, "ego"));
  const std::vector<Answer> all = answers.answers(snapshot);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].action.vehicle_id, "ego");
  EXPECT_EQ(all[1].action.vehicle_id, "bg_7");
  const auto latencies = latenciesOf(all);
  ASSERT_EQ(latencies.size(), 2U);
  EXPECT_EQ(latencies[1].planner, "cbv:sample");
}

TEST(TickAnswers, ExternalEgoMayGiveItsStampAloneAndNoName) {
  const msgs::TrafficSnapshot snapshot = toMsg(test::sampleSnapshot(4));
  auto control = boost::make_shared<msgs::ControlAction>();
  control->header.stamp = ros::Time(0.2);  // tick 4 of 0.05 s
  control->throttle = 0.5;
  TickAnswers answers;
  answers.add(ChannelId::kEgoControl, control);
  answers.add(ChannelId::kSelection, selectionFor(4, 1, "bg_gone"));
  EXPECT_EQ(namesOf(answers.missing(snapshot)), Texts());
  const std::vector<Answer> all = answers.answers(snapshot);
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].action.slot, -1);
  EXPECT_EQ(all[0].action.vehicle_id, "ego");
  EXPECT_EQ(all[0].planner, "ego:external");
}

TEST(TickAnswers, ForgetsOlderTicksOnly) {
  TickAnswers answers;
  answers.add(ChannelId::kEgoControl, controlFor(2, -1, "ego"));
  answers.add(ChannelId::kEgoControl, controlFor(4, -1, "ego"));
  answers.forgetBefore(4);
  EXPECT_EQ(answers.control(kEgoSlot, 2), nullptr);
  EXPECT_NE(answers.control(kEgoSlot, 4), nullptr);
}

msgs::TickAck ackOf(const std::string& node, std::uint8_t kind, std::uint64_t tick = 0,
                    const std::string& text = "") {
  msgs::TickAck ack;
  ack.node = node;
  ack.kind = kind;
  ack.tick = tick;
  ack.text = text;
  return ack;
}

TEST(ParticipantTracker, FollowsNodesFromWaitingToFinished) {
  ParticipantTracker book({kMetricsNode, kEgoPlannerNode});
  EXPECT_EQ(book.notReady(),
            (Texts{"ego_planner_node has not started", "metrics_node has not started"}));
  book.note(ackOf(kMetricsNode, msgs::TickAck::WAITING, 0, "no node publishes /ego/control yet"));
  book.note(ackOf(kEgoPlannerNode, msgs::TickAck::READY));
  EXPECT_EQ(book.notReady(),
            Texts{"metrics_node is not ready (no node publishes /ego/control yet)"});
  book.note(ackOf(kMetricsNode, msgs::TickAck::READY));
  EXPECT_EQ(book.notReady(), Texts());
  EXPECT_EQ(book.notAcknowledged(0),
            Texts{kMetricsNode});  // being ready is no acknowledgement; planners give none
  book.note(ackOf(kMetricsNode, msgs::TickAck::ACKNOWLEDGED, 0));
  EXPECT_EQ(book.notAcknowledged(0), Texts());
  EXPECT_EQ(book.notAcknowledged(1), Texts{kMetricsNode});
  EXPECT_EQ(book.notFinished(), Texts{kMetricsNode});
  book.note(ackOf(kMetricsNode, msgs::TickAck::FINISHED, 1));
  EXPECT_TRUE(book.finished(kMetricsNode));
}

TEST(ParticipantTracker, KeepsTheFirstErrorAndIgnoresStrangers) {
  ParticipantTracker book({kMetricsNode});
  book.note(ackOf("stranger", msgs::TickAck::ERROR, 0, "not ours"));
  EXPECT_FALSE(book.error().has_value());
  book.note(ackOf(kMetricsNode, msgs::TickAck::ERROR, 3, "disk full"));
  book.note(ackOf(kMetricsNode, msgs::TickAck::ERROR, 3, "again"));
  ASSERT_TRUE(book.error().has_value());
  EXPECT_EQ(book.error()->text, "disk full");
}

TEST(Connections, CountsOnNamedNodesOnly) {
  Connections connections;
  connections.expect("traffic", {kMetricsNode});
  EXPECT_EQ(connections.missing().size(), 1U);
  connections.connected("traffic", "/rostopic_1234");
  EXPECT_EQ(connections.missing().size(), 1U);
  connections.connected("traffic", "/metrics_node");
  EXPECT_TRUE(connections.missing().empty());
  connections.disconnected("traffic", "/rostopic_1234");
  EXPECT_TRUE(connections.left().empty());
  connections.disconnected("traffic", "/metrics_node");
  EXPECT_EQ(connections.left(), Texts{kMetricsNode});
}

TEST(Topics, ListenersAreThoseThatTakePart) {
  const SessionGraph graph{{kCbvIdentificationNode, kMetricsNode}, 2, false};
  EXPECT_EQ(listeners(ChannelId::kTraffic, graph), (Texts{kCbvIdentificationNode, kMetricsNode}));
  EXPECT_EQ(listeners({ChannelId::kCbvControl, 1}, graph),
            (Texts{kTrafficSimulatorNode, kMetricsNode}));
  EXPECT_EQ(listeners({ChannelId::kCbvControl, 2}, graph), Texts());  // there is no slot 2
  EXPECT_EQ(listeners({ChannelId::kCbvRollout, 1}, graph), Texts{kMetricsNode});
  EXPECT_EQ(listeners(ChannelId::kTickAck, graph), Texts{kTrafficSimulatorNode});
}

session::ScenarioOptions scenarioWith(const std::string& ego, const std::string& cbv) {
  session::ScenarioOptions options;
  options.ego_planner = ego;
  options.cbv_planner = cbv;
  return options;
}

TEST(SessionGraph, WithoutASeeingPlannerThereIsNoCamera) {
  const SessionGraph graph = graphOf(scenarioWith("pdm_lite", "pdm_lite"), {true, false});
  EXPECT_EQ(graph.participants, (Texts{kCbvIdentificationNode, kEgoPlannerNode, kCbvPlannerNode,
                                       kMetricsNode, kRecorderNode}));
  EXPECT_EQ(listeners({ChannelId::kCbvImage, 0}, graph), Texts());
}

TEST(SessionGraph, CamerasForLookingFeedTheRecorderOnly) {
  const SessionGraph graph = graphOf(scenarioWith("external", "pdm_lite"), {true, true});
  EXPECT_FALSE(graph.has(kEgoPlannerNode));
  EXPECT_EQ(listeners({ChannelId::kCbvImage, 0}, graph), Texts{kRecorderNode});
  EXPECT_EQ(listeners(ChannelId::kEgoImage, graph), Texts{kRecorderNode});
  EXPECT_TRUE(graph.has(kCameraNode));
}

TEST(SessionGraph, DiffusionPlannerReplacesTheOtherAndSeesTheSlots) {
  const SessionGraph graph = graphOf(scenarioWith("pdm_lite", "diffusion"), {false, false});
  EXPECT_EQ(graph.participants, (Texts{kCbvIdentificationNode, kEgoPlannerNode,
                                       kDiffusionPlannerNode, kMetricsNode, kCameraNode}));
  EXPECT_EQ(listeners({ChannelId::kCbvImage, 1}, graph),
            (Texts{kDiffusionPlannerNode, kMetricsNode}));
  EXPECT_EQ(listeners(ChannelId::kEgoImage, graph), Texts());
  EXPECT_EQ(listeners(ChannelId::kGuidance, graph), Texts{kMetricsNode});
  EXPECT_EQ(answererOf({ChannelId::kCbvControl, 1}, graph), kDiffusionPlannerNode);
}

TEST(SessionGraph, EgoThatSeesHasItsImageAloneAndAllComesBackFromTheMessage) {
  msgs::SessionInfo info;
  info.scenario_yaml = "max_cbv: 3\ncbv_planner: pdm_lite\n";
  putGraph(graphOf(scenarioWith("diffusion", "pdm_lite"), {true, false}), info);
  const SessionGraph graph = graphOf(info);
  EXPECT_EQ(graph.max_cbv, 3);
  EXPECT_EQ(listeners(ChannelId::kEgoImage, graph),
            (Texts{kEgoPlannerNode, kMetricsNode, kRecorderNode}));
  EXPECT_EQ(listeners({ChannelId::kCbvImage, 0}, graph), Texts());
}

}  // namespace
}  // namespace cdiff::node_graph
