// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>

#include "core/file.h"
#include "e2e_cdiff/GuidanceReport.h"
#include "node_graph/bags/recorded_channels.h"
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

TEST(Channels, RowsStandInTheOrderOfTheirIdsAndNamesAreUnique) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < channels().size(); ++i) {
    EXPECT_EQ(static_cast<std::size_t>(channels()[i].id), i) << channels()[i].name;
    EXPECT_TRUE(names.insert(channels()[i].name).second) << channels()[i].name;
  }
  EXPECT_EQ(channels().back().id, ChannelId::kPerceptionMarkers);  // the last of the ids
}

TEST(Channels, WhatIsWaitedForIsCollectedRecordedAndHasListeners) {
  for (const Channel& row : channels()) {
    const bool slots = std::string(row.name).find('K') != std::string::npos;
    EXPECT_EQ(slots, row.scope == Scope::kSlot) << row.name;
    if (row.need == Need::kNothing) continue;
    EXPECT_EQ(row.use, Use::kAnswer) << row.name;
    EXPECT_EQ(row.recorded, Recorded::kDecision) << row.name;
    EXPECT_FALSE(row.listeners.empty()) << row.name;
  }
}

TEST(Channels, ATypeThatIsNotTheTopicsIsRefused) {
  EXPECT_THROW(requireType(ChannelId::kTraffic, typeid(msgs::CbvSelection)), std::logic_error);
  EXPECT_NO_THROW(requireType(ChannelId::kTraffic, typeid(msgs::TrafficSnapshot)));
}

TEST(Channels, TheDocumentationShowsTheTable) {
  const std::string page = core::readFile(E2E_CDIFF_DOCS "/ros_api.md", "documentation");
  EXPECT_NE(page.find(channelTable()), std::string::npos)
      << "docs/ros_api.md must hold this table:\n\n"
      << channelTable();
}

/// Whether a series of a plotting tool, "/TOPIC/FIELD" or "/TOPIC.FIELD", is of one of our topics.
bool isOfATopic(const std::string& series) {
  for (const Channel& row : channels()) {
    std::string name = row.name;
    const std::size_t slot = name.find('K');
    if (slot != std::string::npos) name[slot] = '0';
    if (name.front() != '/') name.insert(0, "/");
    const bool begins = series.compare(0, name.size(), name) == 0;
    if (begins &&
        (series.size() == name.size() || series.find_first_of("/.", name.size()) == name.size()))
      return true;
  }
  return false;
}

TEST(Channels, LayoutsOfPlottingToolsNameOurTopics) {
  for (const char* file : {"plotjuggler.xml", "foxglove.json"}) {
    const std::string text =
        core::readFile(core::shareFolder() / "config" / "layouts" / file, "layout");
    const std::regex quoted("\"(/[a-z][^\" ]*)\"");
    const std::sregex_iterator begin(text.begin(), text.end(), quoted);
    EXPECT_GE(std::distance(begin, {}), 5) << file;
    for (auto series = begin; series != std::sregex_iterator(); ++series)
      EXPECT_TRUE(isOfATopic((*series)[1])) << file << ": " << (*series)[1];
  }
}

TEST(Channels, ViewsOfRvizNameOurTopics) {
  for (const char* view : {"session", "replay", "debug", "steering"}) {
    const std::string file = std::string(view) + ".rviz";
    const std::string text = core::readFile(core::shareFolder() / "rviz" / file, "view");
    const std::regex topic("Topic: (/[^\\s]+)");
    const std::sregex_iterator begin(text.begin(), text.end(), topic);
    EXPECT_GE(std::distance(begin, {}), 5) << file;
    for (auto named = begin; named != std::sregex_iterator(); ++named) {
      const std::string name = (*named)[1];
      EXPECT_TRUE(isOfATopic(name) || name == "/clicked_point") << file << ": " << name;
    }
  }
}

/// Everybody takes part.
SessionGraph graphWith(bool cbvs_see, bool cbvs_guided) {
  SessionGraph graph{{kCbvPlannerNode, kCameraNode, kMetricsNode, kRecorderNode}, 2};
  graph.cbvs_see = cbvs_see;
  graph.cbvs_guided = cbvs_guided;
  return graph;
}

TEST(SightAndGuidance, NeitherFollowsFromTheOther) {
  const Topic image(ChannelId::kCbvImage, 1);
  const SessionGraph sees = graphWith(true, false);
  EXPECT_EQ(listeners(image, sees), (Texts{kCbvPlannerNode, kMetricsNode, kRecorderNode}));
  EXPECT_EQ(listeners(ChannelId::kGuidance, sees), Texts());
  EXPECT_EQ(awaitedBy(Party::kMetrics, sees).count(ChannelId::kGuidance), 0U);
  EXPECT_FALSE(replayed(channel(ChannelId::kGuidance), sees));
  const SessionGraph guided = graphWith(false, true);
  EXPECT_EQ(listeners(image, guided), Texts());
  EXPECT_EQ(listeners(ChannelId::kGuidance, guided), (Texts{kMetricsNode, kRecorderNode}));
  EXPECT_EQ(awaitedBy(Party::kMetrics, guided).count(ChannelId::kCbvImage), 0U);
  EXPECT_TRUE(replayed(channel(ChannelId::kGuidance), guided));
}

/// The camera that shows the ego alone takes no selection, so that no one may wait until it does.
TEST(SightAndGuidance, TheCameraHearsOfCbvsWhereItShowsThem) {
  const auto hears = [](const SessionGraph& graph) {
    const Texts nodes = listeners(ChannelId::kSelection, graph);
    return std::count(nodes.begin(), nodes.end(), kCameraNode) == 1;
  };
  SessionGraph graph = graphWith(false, false);
  graph.ego_sees = true;
  EXPECT_FALSE(hears(graph));
  graph.show_cameras = true;
  EXPECT_TRUE(hears(graph));
  EXPECT_TRUE(hears(graphWith(true, false)));
}

TEST(SightAndGuidance, ARecordedReportIsReadWhereThePlannerIsGuided) {
  const MessageType& type = channel(ChannelId::kGuidance).type;
  const BagConnection connection{"/cbv/guidance", type.name, type.md5sum};
  EXPECT_TRUE(recordedTopic(connection, "cbv/guidance", graphWith(false, true), false).topic);
  EXPECT_FALSE(recordedTopic(connection, "cbv/guidance", graphWith(true, false), false).topic);
}

TEST(SightAndGuidance, BothComeFromTheScenarioInTheSessionsMessage) {
  msgs::SessionInfo info;
  info.participants = {kCbvPlannerNode};
  info.scenario_yaml = "cbv_planner: two_stage_pid\n";
  SessionGraph graph = graphOf(info);
  EXPECT_TRUE(graph.cbvs_see);
  EXPECT_TRUE(graph.cbvs_guided);
  EXPECT_EQ(graph.cbv_planner_node, kCbvPlannerNode);  // the one that takes part
  info.participants = {kDiffusionPlannerNode};
  info.scenario_yaml = "cbv_planner: pdm_lite\n";
  graph = graphOf(info);
  EXPECT_FALSE(graph.cbvs_see);
  EXPECT_FALSE(graph.cbvs_guided);
  EXPECT_EQ(graph.cbv_planner_node, kDiffusionPlannerNode);
}

/// The answer for the CBV of slot 1 of the sample snapshot.
Answer sampleAnswer() {
  Answer answer;
  answer.action.slot = 1;
  answer.action.vehicle_id = "bg_7";
  answer.action.action = {0.1, -0.2, 0.0};
  answer.action.rollout = {{{{1.0, 2.0}, 3.0, 0.5, 6.0}, {0.1, 0.2, 0.0}}};
  answer.action.guidance.candidates = 3;
  answer.action.guidance.chosen = 1;
  guidance::ChallengeReport& challenge = answer.action.guidance.challenge;
  challenge.state = "attacks";
  challenge.chosen = 1;
  challenge.delta = 0.375;
  challenge.last_brake_time = 1.5;
  challenge.ghost = traffic::VehicleState{{7.0, 8.0}, 0.0, 0.25, 5.0};
  challenge.refusals = {"from behind", ""};
  answer.action.state_mismatch = 0.25;
  answer.planner = "cbv:sample";
  answer.latency_ms = 1.5;
  return answer;
}

TEST(TickMessages, AnAnswerBecomesMessagesAndComesBack) {
  const traffic::TrafficSnapshot snapshot = test::sampleSnapshot(4);
  const std::vector<session::SlotImage> images = {{1, {2, 1, 4, {1, 2, 3, 4, 5, 6}}}};
  TickValues values{snapshot, nullptr, 0.05, true};
  values.answers = {sampleAnswer()};
  values.images = &images;
  TickReading reading;
  rendering::CameraOptions camera;
  camera.width = 2;
  camera.height = 1;
  reading.rigs = session::VehicleRigs::front(camera);
  const TickMessages messages = makeMessages(values, 2, reading.rigs);
  const auto answer = readAnswer(messages, 1, "bg_7", reading);
  ASSERT_TRUE(answer.has_value());
  EXPECT_EQ(answer->action.action, (traffic::ControlAction{0.1, -0.2, 0.0}));
  ASSERT_EQ(answer->action.rollout.size(), 1U);
  EXPECT_EQ(answer->action.rollout[0].state.speed, 6.0);
  EXPECT_EQ(answer->action.guidance.candidates, 3);
  const guidance::ChallengeReport& challenge = answer->action.guidance.challenge;
  EXPECT_EQ(challenge.state, "attacks");
  EXPECT_EQ(challenge.chosen, 1);
  EXPECT_EQ(challenge.delta, 0.375);
  EXPECT_EQ(challenge.last_brake_time, std::optional<double>(1.5));
  ASSERT_TRUE(challenge.ghost.has_value());
  EXPECT_EQ(challenge.ghost->position, Eigen::Vector2d(7.0, 8.0));
  EXPECT_EQ(challenge.ghost->speed, 5.0);
  EXPECT_EQ(challenge.refusals, (std::vector<std::string>{"from behind", ""}));
  EXPECT_EQ(answer->action.state_mismatch, 0.25);
  EXPECT_EQ(answer->planner, "cbv:sample");
  EXPECT_EQ(answer->latency_ms, 1.5);
  ASSERT_EQ(answer->images.size(), 1U);
  EXPECT_EQ(answer->images[0].slot, 1);
  EXPECT_EQ(answer->images[0].camera, "front");
  EXPECT_EQ(answer->images[0].image.rgb, images[0].image.rgb);
  EXPECT_FALSE(readAnswer(messages, 0, "bg_7", reading).has_value());
}

TEST(TickMessages, WhatAPlannerOfOthersIsCalledAndSaysIsCutAndMadePlain) {
  const std::string loud = "\033[31m" + std::string(1'000'000, 'x');
  const auto control = test::controlFor(4, kEgoSlot, "ego");
  control->planner = loud;
  control->fault = loud;
  TickMessages messages;
  messages.add(ChannelId::kEgoControl, control);
  const auto answer = readAnswer(messages, kEgoSlot, "ego", TickReading());
  ASSERT_TRUE(answer.has_value());
  for (const std::string& text : {answer->planner, answer->fault, answer->action.fault}) {
    EXPECT_GT(text.size(), 10U);
    EXPECT_LT(text.size(), 10000U);
    EXPECT_EQ(text.find('\033'), std::string::npos);
  }
}

/// A rig of two cameras of 2 x 1 pixels for the CBVs.
session::VehicleRigs twoCameras() {
  session::ScenarioOptions options;
  options.cbv_rig.preset = rendering::kOwnRig;
  options.cbv_rig.cameras.resize(2);
  options.cbv_rig.cameras[1].name = "rear";
  for (rendering::RigCamera& camera : options.cbv_rig.cameras) {
    camera.width = 2;
    camera.height = 1;
  }
  return session::VehicleRigs(options);
}

TEST(TickMessages, EachCameraHasItsTopicAndComesBackInTheRigsOrder) {
  const traffic::TrafficSnapshot snapshot = test::sampleSnapshot(4);
  const session::VehicleRigs rigs = twoCameras();
  const std::vector<session::SlotImage> images = {{1, {2, 1, 4, {1, 2, 3, 4, 5, 6}}, "front"},
                                                  {1, {2, 1, 4, {6, 5, 4, 3, 2, 1}}, "rear"}};
  TickValues values{snapshot, nullptr, 0.05, true};
  values.answers = {sampleAnswer()};
  values.images = &images;
  TickMessages messages = makeMessages(values, 2, rigs);
  const auto rear = messages.get<sensor_msgs::Image>(imageOf(1, "rear"));
  ASSERT_TRUE(rear);
  EXPECT_EQ(imageOf(1, "rear").name(), "cbv_1/camera_rear/image_raw");
  EXPECT_EQ(cameraInfoOf(kEgoSlot, "rear").name(), "ego/camera_rear/camera_info");
  EXPECT_EQ(rear->header.frame_id, "bg_7/camera_rear_optical");
  const TickReading reading{rigs, 0.05};
  const auto answer = readAnswer(messages, 1, "bg_7", reading);
  ASSERT_TRUE(answer.has_value());
  ASSERT_EQ(answer->images.size(), 2U);
  EXPECT_EQ(answer->images[1].camera, "rear");
  EXPECT_EQ(answer->images[1].image.rgb, images[1].image.rgb);
  const auto info = messageAs<sensor_msgs::CameraInfo>(
      deriveCameraInfo(messages, reading, cameraInfoOf(1, "rear")));
  ASSERT_TRUE(info);
  EXPECT_EQ(info->width, 2U);
  EXPECT_EQ(info->header.frame_id, "bg_7/camera_rear_optical");
}

TEST(Topics, ARowOfCamerasHasATopicPerCamera) {
  const Channel& row = channel(ChannelId::kCbvImage);
  EXPECT_EQ(namesOf(topicsOf(row, 2, twoCameras())),
            (std::vector<std::string>{"cbv_0/camera/image_raw", "cbv_0/camera_rear/image_raw",
                                      "cbv_1/camera/image_raw", "cbv_1/camera_rear/image_raw"}));
  EXPECT_EQ(namesOf(topicsOf(channel(ChannelId::kEgoImage), 2, twoCameras())),
            std::vector<std::string>{"ego/camera/image_raw"});
}

TEST(TickMessages, OnlyAGuidedPlannerReportsGuidance) {
  const traffic::TrafficSnapshot snapshot = test::sampleSnapshot(4);
  TickValues values{snapshot, nullptr, 0.05, false};
  values.answers = {sampleAnswer()};
  EXPECT_FALSE(makeMessages(values, 2, {}).holds(ChannelId::kGuidance));
  values.cbvs_guided = true;
  const auto report = makeMessages(values, 2, {}).get<msgs::GuidanceReport>(ChannelId::kGuidance);
  ASSERT_TRUE(report);
  ASSERT_EQ(report->vehicles.size(), 1U);
  EXPECT_EQ(report->planner_latency_ms, 1.5);
  values.answers[0].action.slot = kEgoSlot;  // no CBV to drive
  EXPECT_FALSE(makeMessages(values, 2, {}).holds(ChannelId::kGuidance));
}

}  // namespace
}  // namespace cdiff::node_graph
