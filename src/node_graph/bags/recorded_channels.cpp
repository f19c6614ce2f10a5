// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/bags/recorded_channels.h"

#include "core/text.h"

namespace cdiff::node_graph {
namespace {

std::string wrongType(const BagConnection& connection, const MessageType& expected) {
  if (connection.type != expected.name)
    return "topic '" + connection.topic + "' holds " + connection.type + "; expected " +
           expected.name;
  if (connection.md5sum == expected.md5sum) return "";
  return "topic '" + connection.topic + "' holds " + expected.name + " with MD5 sum " +
         connection.md5sum + "; expected " + expected.md5sum +
         ": it was recorded by another version of the package";
}

/// Whether a recorded session is read from a channel.
bool isRead(const Channel& row, const SessionGraph& graph, bool all_images) {
  if (row.use == Use::kTick || row.id == ChannelId::kSession) return true;
  if (row.use != Use::kAnswer) return false;
  return replayed(row, graph) || (all_images && row.publisher == Party::kCamera);
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

}  // namespace

RecordedTopic recordedTopic(const BagConnection& connection, const std::string& name,
                            const SessionGraph& graph, bool all_images) {
  for (const Channel& row : channels()) {
    if (!isRead(row, graph, all_images)) continue;
    for (const Topic& topic : topicsOf(row, graph)) {
      if (topic.name() == name) return {topic, wrongType(connection, row.type)};
    }
  }
  return {};
}

std::string sessionPrefix(const std::vector<BagConnection>& connections) {
  const MessageType& type = channel(ChannelId::kSession).type;
  const std::string name = Topic(ChannelId::kSession).name();
  std::string wrong;
  for (const BagConnection& connection : connections) {
    const std::string& topic = connection.topic;
    const std::string fault = wrongType(connection, type);
    if (fault.empty() && core::endsWith(topic, name))
      return topic.substr(0, topic.size() - name.size());
    if (connection.type == type.name || core::endsWith(topic, "/" + name)) wrong = fault;
  }
  if (!wrong.empty()) throw core::InputError(wrong);
  throw core::InputError("it holds no session (a message of type " + type.name + "); it holds " +
                         contentText(connections));
}

}  // namespace cdiff::node_graph
