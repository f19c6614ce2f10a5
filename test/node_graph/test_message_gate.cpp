// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <chrono>
#include <cstring>

#include "e2e_cdiff/CbvSelection.h"
#include "node_graph/lockstep/message_gate.h"
#include "node_graph/lockstep/participant_tracker.h"
#include "node_graph/messages/message_checks.h"
#include "node_graph/messages/topics.h"

namespace cdiff::node_graph {
namespace {

namespace msgs = ::e2e_cdiff;
using Texts = std::vector<std::string>;

/// Keeps what a gate reports.
struct GateLog {
  explicit GateLog(MessageGate& gate) {
    gate.setReport([this](const std::string& text) { texts.push_back(text); });
  }
  Texts texts;
};

TEST(MessageGate, AdmitsTheTopicsPublisherAlone) {
  MessageGate gate;
  GateLog log(gate);
  EXPECT_TRUE(gate.admits("cbv/selection", {"/a", "/b"}, "/b"));
  EXPECT_FALSE(gate.admits("cbv/selection", {"/a", "/b"}, "/other/a"));
  EXPECT_EQ(log.texts, Texts{"1 message on cbv/selection from /other/a is ignored: the session "
                             "listens to /a"});
}

TEST(MessageGate, WhoeverComesFirstCountsWhereAnyoneMaySend) {
  MessageGate gate;
  EXPECT_TRUE(gate.admits("ego/control", {}, "/mine"));
  EXPECT_FALSE(gate.admits("ego/control", {}, "/second"));
  EXPECT_TRUE(gate.admits("ego/control", {}, "/mine"));
}

/// What a node that listens to /selector reads of a selection of one vehicle that says it has
/// `length`, as `caller` sends it.
ros::VoidConstPtr readFrom(const std::string& caller, std::uint32_t length) {
  msgs::CbvSelection selection;
  std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(selection));
  const std::size_t assignments = bytes.size() - 3 * sizeof(length);  // before two other lists
  selection.assignments.resize(1);
  bytes.resize(ros::serialization::serializationLength(selection));
  ros::serialization::OStream output(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(output, selection);
  std::memcpy(&bytes[assignments], &length, sizeof(length));
  const auto header = boost::make_shared<ros::M_string>();
  (*header)["callerid"] = caller;
  MessageReader<msgs::CbvSelection> reader({"/selector"}, [](const auto&) {});
  return reader.deserialize({bytes.data(), static_cast<std::uint32_t>(bytes.size()), header});
}

TEST(MessageReader, ReadsTheBytesOfTheTopicsPublisherAlone) {
  const auto assignments = [](const ros::VoidConstPtr& read) {
    return boost::static_pointer_cast<const msgs::CbvSelection>(read)->assignments.size();
  };
  EXPECT_EQ(assignments(readFrom("/selector", 1)), 1U);
  EXPECT_EQ(assignments(readFrom("/stranger", 1)), 0U);
  // A list that the bytes do not hold.
  EXPECT_THROW(readFrom("/selector", 1000), ros::serialization::StreamOverrunException);
  EXPECT_EQ(assignments(readFrom("/stranger", 1000)), 0U);
}

TEST(MessageGate, RefusesTicksThatHaveNotBeen) {
  MessageGate gate;
  EXPECT_TRUE(gate.admitsTick("ego/control", "/ego", 7));  // no tick is known yet
  gate.setNewestTick(6, 0.05);
  EXPECT_TRUE(gate.admitsTick("ego/control", "/ego", 6));
  EXPECT_FALSE(gate.admitsTick("ego/control", "/ego", 7));
}

TEST(MessageGate, ReportsAtPowersOfTenAndCountsTheRest) {
  MessageGate gate;
  GateLog log(gate);
  for (int i = 0; i < 1234; ++i) gate.refuse("ego/control", "/rogue", "why");
  ASSERT_EQ(log.texts.size(), 4U);  // the 1st, 10th, 100th and 1000th
  EXPECT_EQ(log.texts[3], "1000 messages on ego/control from /rogue so far are ignored: why");
  EXPECT_EQ(gate.totals(), Texts{"1234 messages on ego/control from /rogue were ignored in all"});
}

TEST(MessageGate, CountsManySendersTogether) {
  MessageGate gate;
  GateLog log(gate);
  for (int i = 0; i < 10000; ++i) gate.refuse("traffic", "/rogue_" + std::to_string(i), "why");
  // 100 of their own; the other 9900 report at 1, 10, 100 and 1000.
  EXPECT_EQ(log.texts.size(), 104U);
  EXPECT_EQ(gate.totals(), Texts{"9900 messages on any topic from others were ignored in all"});
}

TEST(Selection, WithSlotsThatThereAreNotCannotBeUsed) {
  const auto unusableWith = [](const std::vector<std::pair<int, std::string>>& assigned) {
    msgs::CbvSelection selection;
    for (const auto& [slot, vehicle] : assigned) {
      selection.assignments.emplace_back();
      selection.assignments.back().slot = slot;
      selection.assignments.back().vehicle_id = vehicle;
    }
    return unusable(selection, 2);
  };
  EXPECT_EQ(unusableWith({{0, "a"}, {1, "b"}}), "");
  EXPECT_NE(unusableWith({{2, "a"}}).find("slot 2"), std::string::npos);
  EXPECT_NE(unusableWith({{-1, "a"}}), "");
  EXPECT_NE(unusableWith({{0, "a"}, {0, "b"}}).find("twice"), std::string::npos);
  EXPECT_NE(unusableWith({{0, "a"}, {1, "a"}}).find("twice"), std::string::npos);
  EXPECT_NE(unusableWith({{0, "a"}, {1, "b"}, {0, "c"}}).find("3 assignments"), std::string::npos);
}

TEST(SilenceWatch, CountsOnlyTheTimeOfItsOwnLooks) {
  SilenceWatch watch;
  EXPECT_FALSE(watch.silent(100.0));  // no one was ever heard
  watch.heard(1.0);
  EXPECT_FALSE(watch.silent(130.0));  // one look adds 0.5 s, however long we did not look
  EXPECT_FALSE(watch.silent(130.5));  // 1.0 s is not longer than 1.0 s
  EXPECT_TRUE(watch.silent(130.6));
  watch.heard(1.0);
  EXPECT_FALSE(watch.silent(130.7));
}

msgs::TickAck ackFrom(const std::string& node, std::uint8_t kind) {
  msgs::TickAck message;
  message.node = node;
  message.kind = kind;
  return message;
}

TEST(ParticipantTracker, WhoSaysNothingAtAllIsSilentAndWhoWaitsIsNot) {
  using namespace std::chrono_literals;
  const ParticipantTracker::Clock::time_point begin;
  ParticipantTracker book({kCameraNode, kCbvPlannerNode, kMetricsNode});
  book.note(ackFrom(kCameraNode, msgs::TickAck::READY), begin);
  book.note(ackFrom(kCbvPlannerNode, msgs::TickAck::READY), begin);
  book.note(ackFrom(kCbvPlannerNode, msgs::TickAck::ALIVE), begin + 3s);
  EXPECT_EQ(book.silent(5.0, begin + 5s), std::vector<std::string>());
  EXPECT_EQ(book.silent(5.0, begin + 6s), std::vector<std::string>{kCameraNode});
  EXPECT_TRUE(book.heard(kCameraNode));
  EXPECT_FALSE(book.heard(kMetricsNode));
}

TEST(Connections, KnowsWhoListenedAndDoesNotAnyMore) {
  Connections connections;
  EXPECT_FALSE(connections.stoppedListening("/my_ego"));  // it never did
  connections.connected("traffic", "/my_ego");
  connections.connected("/clock", "/my_ego");
  connections.disconnected("traffic", "/my_ego");
  EXPECT_FALSE(connections.stoppedListening("/my_ego"));
  connections.disconnected("/clock", "/my_ego");
  EXPECT_TRUE(connections.stoppedListening("/my_ego"));
  EXPECT_TRUE(connections.left().empty());  // no one had counted on it
}

}  // namespace
}  // namespace cdiff::node_graph
