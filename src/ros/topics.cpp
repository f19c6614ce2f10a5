// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/topics.h"

#include <algorithm>
#include <stdexcept>

#include "e2e_cdiff/CbvSelection.h"
#include "ros/message_checks.h"

namespace cdiff::ros {

std::string Topic::name() const {
  std::string name = row().name;
  if (row().scope == Scope::kSlot) name.replace(name.find('K'), 1, std::to_string(slot));
  return name;
}

Topic controlOf(int slot) {
  return {slot == kEgoSlot ? ChannelId::kEgoControl : ChannelId::kCbvControl, slot};
}
Topic imageOf(int slot) {
  return {slot == kEgoSlot ? ChannelId::kEgoImage : ChannelId::kCbvImage, slot};
}
Topic cameraInfoOf(int slot) {
  return {slot == kEgoSlot ? ChannelId::kEgoCameraInfo : ChannelId::kCbvCameraInfo, slot};
}

std::vector<Topic> topicsOf(const Channel& channel, int max_cbv) {
  if (channel.scope != Scope::kSlot) return {channel.id};
  std::vector<Topic> topics;
  for (int slot = 0; slot < max_cbv; ++slot) topics.emplace_back(channel.id, slot);
  return topics;
}

std::vector<std::string> namesOf(const std::vector<Topic>& topics) {
  std::vector<std::string> names;
  for (const Topic& topic : topics) names.push_back(topic.name());
  return names;
}

bool listensTo(const Channel& channel, Party party, const SessionGraph& graph) {
  return std::any_of(channel.listeners.begin(), channel.listeners.end(),
                     [&](const Listener& listener) {
                       return listener.party == party && listener.when.holds(graph);
                     });
}

std::vector<std::string> listeners(const Topic& topic, const SessionGraph& graph) {
  std::vector<std::string> nodes;
  if (topic.row().scope == Scope::kSlot && topic.slot >= graph.max_cbv) return nodes;
  for (const Listener& listener : topic.row().listeners) {
    const std::string node = nodeOf(listener.party, graph);
    const bool there = listener.party == Party::kSimulator || graph.has(node);
    if (there && listener.when.holds(graph)) nodes.push_back(node);
  }
  return nodes;
}

bool replayed(const Channel& channel, const SessionGraph& graph) {
  SessionGraph seen = graph;
  seen.show_cameras = false;
  if (channel.use != Use::kAnswer && channel.publisher != Party::kCamera) return false;
  return channel.published.holds(seen);
}

std::vector<std::string> publishersOf(const Topic& topic, const SessionGraph& graph) {
  const Channel& row = topic.row();
  if (row.publisher == Party::kParticipants) return graph.participants;
  if (row.publisher == Party::kEgoPlanner && graph.external_ego) return {};
  const std::string node = nodeOf(row.publisher, graph);
  if (row.use != Use::kAnswer || row.publisher == Party::kSimulator) return {node};
  return {node, kTrafficSimulatorNode};
}

std::string answererOf(const Topic& topic, const SessionGraph& graph) {
  return nodeOf(topic.row().publisher, graph);
}

ChannelSet awaitedBy(Party party, const SessionGraph& graph) {
  ChannelSet awaited;
  for (const Channel& row : channels()) {
    if (row.need != Need::kNothing && listensTo(row, party, graph)) awaited.insert(row.id);
  }
  return awaited;
}

std::string unusable(const AnyMessage& message, const Topic& topic, const SessionGraph& graph) {
  const Channel& row = topic.row();
  const std::optional<int> slot = row.type.slot(message);
  if (row.scope == Scope::kSlot && slot && *slot != topic.slot) return wrongSlot(*slot);
  if (topic.id != ChannelId::kSelection) return "";
  return unusable(*messageAs<::e2e_cdiff::CbvSelection>(message), graph.max_cbv);
}

void requireType(ChannelId id, const std::type_index& type) {
  if (channel(id).type.type == type) return;
  throw std::logic_error(std::string("messages on ") + channel(id).name + " are of type " +
                         channel(id).type.name);
}

}  // namespace cdiff::ros
