// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/messages/topics.h"

#include <algorithm>
#include <stdexcept>

#include "core/text.h"
#include "e2e_cdiff/CbvSelection.h"
#include "node_graph/lockstep/hosted_nodes.h"
#include "node_graph/messages/channels.h"
#include "node_graph/messages/message_checks.h"

namespace cdiff::node_graph {

std::string Topic::name() const {
  std::string name = row().name;
  if (row().scope == Scope::kSlot) name.replace(name.find('K'), 1, std::to_string(slot));
  const std::string folder = "/camera";
  if (camera != rendering::kFrontCamera)
    name.insert(name.find(folder) + folder.size(), "_" + camera);
  return name;
}

Topic controlOf(int slot) {
  return {slot == kEgoSlot ? ChannelId::kEgoControl : ChannelId::kCbvControl, slot};
}
Topic imageOf(int slot, const std::string& camera) {
  return {slot == kEgoSlot ? ChannelId::kEgoImage : ChannelId::kCbvImage, slot, camera};
}
Topic cameraInfoOf(int slot, const std::string& camera) {
  return {slot == kEgoSlot ? ChannelId::kEgoCameraInfo : ChannelId::kCbvCameraInfo, slot, camera};
}

Topic egoCommandOf(const SessionGraph& graph) {
  for (const Channel& row : channels()) {
    if (row.use == Use::kCommand && row.published.holds(graph)) return row.id;
  }
  return ChannelId::kEgoControl;
}

std::vector<Topic> topicsOfSlot(const Channel& channel, int slot,
                                const session::VehicleRigs& rigs) {
  if (!channel.per_camera) return {{channel.id, slot}};
  std::vector<Topic> topics;
  for (const std::string& camera : rigs.of(slot).names())
    topics.emplace_back(channel.id, slot, camera);
  return topics;
}

std::vector<Topic> topicsOf(const Channel& channel, int max_cbv, const session::VehicleRigs& rigs) {
  if (channel.scope != Scope::kSlot) return topicsOfSlot(channel, kEgoSlot, rigs);
  std::vector<Topic> topics;
  for (int slot = 0; slot < max_cbv; ++slot) {
    for (const Topic& topic : topicsOfSlot(channel, slot, rigs)) topics.push_back(topic);
  }
  return topics;
}

std::vector<Topic> topicsOf(const Channel& channel, const SessionGraph& graph) {
  return topicsOf(channel, graph.max_cbv, graph.rigs);
}

std::vector<std::string> namesOf(const std::vector<Topic>& topics) {
  std::vector<std::string> names;
  for (const Topic& topic : topics) names.push_back(topic.name());
  return names;
}

bool isLatched(const Channel& channel) {
  const bool often = channel.use == Use::kTick || channel.use == Use::kAnswer;
  return channel.latched && !(often && hostsNodes());
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
  if (graph.external(row.publisher)) return {};
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

namespace {

std::string partyText(Party party) {
  SessionGraph graph;
  if (party == Party::kParticipants) return "all but the simulator";
  if (party == Party::kCbvPlanner) return "planner of the CBVs";
  if (party == Party::kEgoPlanner) return "planner of the ego";
  return "`" + nodeOf(party, graph) + "`";
}

std::string under(const Condition& condition) {
  return std::string(condition.text).empty() ? "" : std::string(" ") + condition.text;
}

std::string listenersText(const Channel& row) {
  std::vector<std::string> texts;
  for (const Listener& listener : row.listeners)
    texts.push_back(partyText(listener.party) + under(listener.when));
  return core::joinText(texts, ", ");
}

std::string needText(Need need) {
  switch (need) {
    case Need::kNothing:
      return "";
    case Need::kDecision:
      return "at decisions";
    case Need::kVehicle:
      return "of each vehicle asked for";
    case Need::kSight:
      return "of each vehicle whose planner saw";
    case Need::kAnyCbv:
      return "where there is a CBV";
    case Need::kRecord:
      return "at decisions; it names what else came";
  }
  return "";
}

std::string recordedText(Recorded recorded) {
  switch (recorded) {
    case Recorded::kNever:
      return "";
    case Recorded::kOnce:
      return "once";
    case Recorded::kTick:
      return "every tick";
    case Recorded::kDecision:
      return "at decisions";
  }
  return "";
}

}  // namespace

std::string channelTable() {
  std::string text =
      "| Topic | Type | Published by | Listeners | A listener's tick waits for it | In the bag | "
      "Meaning |\n|---|---|---|---|---|---|---|\n";
  for (const Channel& row : channels()) {
    const std::string name = row.name;
    text += "| `" + (name.front() == '/' ? name : "/" + name) + "` | `" + row.type.name + "`" +
            (row.latched ? ", latched" : "") + " | " + partyText(row.publisher) +
            under(row.published) + " | " + listenersText(row) + " | " + needText(row.need) + " | " +
            recordedText(row.recorded) + " | " + row.help + " |\n";
  }
  return text;
}

}  // namespace cdiff::node_graph
