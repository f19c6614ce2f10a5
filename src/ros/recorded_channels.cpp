// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/recorded_channels.h"

#include "core/text.h"
#include "e2e_cdiff/CbvSelection.h"
#include "e2e_cdiff/ControlAction.h"
#include "e2e_cdiff/DecisionRecord.h"
#include "e2e_cdiff/GuidanceReport.h"
#include "e2e_cdiff/Rollout.h"
#include "e2e_cdiff/SessionInfo.h"
#include "e2e_cdiff/TrafficSnapshot.h"
#include "ros/conversions.h"
#include "ros/message_traits.h"
#include "sensor_msgs/Image.h"

namespace cdiff::ros {
namespace {

template <class Message>
std::string wrongType(const BagConnection& connection) {
  const std::string type = ::ros::message_traits::DataType<Message>::value();
  const std::string md5sum = ::ros::message_traits::MD5Sum<Message>::value();
  if (connection.type != type)
    return "topic '" + connection.topic + "' holds " + connection.type + "; expected " + type;
  if (connection.md5sum == md5sum) return "";
  return "topic '" + connection.topic + "' holds " + type + " with MD5 sum " + connection.md5sum +
         "; expected " + md5sum + ": it was recorded by another version of the package";
}

std::optional<Channel> channelOfSlot(const BagConnection& connection, const std::string& topic,
                                     int slot, const SessionGraph& graph, bool all_images) {
  const bool ego = slot == kEgoSlot;
  if (topic == (ego ? kEgoControlTopic : cbvControlTopic(slot)))
    return Channel{ChannelKind::kControl, slot, wrongType<msgs::ControlAction>(connection)};
  if (!ego && topic == cbvRolloutTopic(slot))
    return Channel{ChannelKind::kRollout, slot, wrongType<msgs::Rollout>(connection)};
  const bool seen = ego ? graph.egoPlansFromImages() : graph.cbvsPlanFromImages();
  if ((seen || all_images) && topic == imageTopic(slot))
    return Channel{ChannelKind::kImage, slot, wrongType<sensor_msgs::Image>(connection)};
  return std::nullopt;
}

/// "/words (std_msgs/String), ...", ten at most.
std::string contentText(const std::vector<BagConnection>& connections) {
  constexpr std::size_t kMost = 10;
  std::vector<std::string> texts;
  for (const BagConnection& connection : connections) {
    if (texts.size() == kMost) {
      texts.push_back("... (" + std::to_string(connections.size()) + " in all)");
      break;
    }
    texts.push_back(connection.topic + " (" + connection.type + ")");
  }
  return texts.empty() ? "no topic at all" : core::joinText(texts, ", ");
}

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

}  // namespace

Channel channelOf(const BagConnection& connection, const std::string& topic,
                  const SessionGraph& graph, bool all_images) {
  if (topic == kSessionTopic)
    return {ChannelKind::kSession, kEgoSlot, wrongType<msgs::SessionInfo>(connection)};
  if (topic == kTrafficTopic)
    return {ChannelKind::kTraffic, kEgoSlot, wrongType<msgs::TrafficSnapshot>(connection)};
  if (topic == kDecisionRecordTopic)
    return {ChannelKind::kDecision, kEgoSlot, wrongType<msgs::DecisionRecord>(connection)};
  if (topic == kSelectionTopic)
    return {ChannelKind::kSelection, kEgoSlot, wrongType<msgs::CbvSelection>(connection)};
  if (topic == kGuidanceTopic && graph.cbvsSee())
    return {ChannelKind::kGuidance, kEgoSlot, wrongType<msgs::GuidanceReport>(connection)};
  for (int slot = kEgoSlot; slot < graph.max_cbv; ++slot) {
    if (const auto channel = channelOfSlot(connection, topic, slot, graph, all_images))
      return *channel;
  }
  return {};
}

std::string sessionPrefix(const std::vector<BagConnection>& connections) {
  const std::string name = kSessionTopic;
  std::string wrong;
  for (const BagConnection& connection : connections) {
    const std::string& topic = connection.topic;
    const std::string fault = wrongType<msgs::SessionInfo>(connection);
    if (fault.empty() && endsWith(topic, name)) return topic.substr(0, topic.size() - name.size());
    if (connection.type == "e2e_cdiff/SessionInfo" || endsWith(topic, "/" + name)) wrong = fault;
  }
  if (!wrong.empty()) throw core::InputError(wrong);
  throw core::InputError(
      "it holds no session (a message of type e2e_cdiff/SessionInfo); it holds " +
      contentText(connections));
}

}  // namespace cdiff::ros
