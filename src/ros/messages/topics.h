// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <set>
#include <string>
#include <vector>

#include "ros/messages/channels.h"

namespace cdiff::ros {

// The topics of a session, and who publishes and hears them: what the table of channels says of
// one session.

/// One topic: a channel and, where it has one topic per slot, the slot.
struct Topic {
  Topic(ChannelId channel_id, int of_slot = kEgoSlot) : id(channel_id), slot(of_slot) {}  // NOLINT

  ChannelId id;
  int slot;  ///< kEgoSlot unless the channel is of slots

  const Channel& row() const { return channel(id); }
  /// Name relative to the session's namespace; absolute names start with a slash.
  std::string name() const;
  bool operator==(const Topic& other) const { return id == other.id && slot == other.slot; }
  bool operator<(const Topic& other) const {
    return id != other.id ? id < other.id : slot < other.slot;
  }
};

/// Topics of a vehicle; `slot`: kEgoSlot for the ego.
Topic controlOf(int slot);
Topic imageOf(int slot);
Topic cameraInfoOf(int slot);

/// The topics of a channel in a session with so many slots.
std::vector<Topic> topicsOf(const Channel& channel, int max_cbv);

std::vector<std::string> namesOf(const std::vector<Topic>& topics);

/// Nodes that listen to a topic in this session, by name; a publisher waits for them before the
/// first tick.
std::vector<std::string> listeners(const Topic& topic, const SessionGraph& graph);

/// The nodes whose messages count on a topic, without namespace: its publisher, and the traffic
/// simulator where a replay publishes in its name. Empty where whoever comes first counts (the
/// control of an external ego).
std::vector<std::string> publishersOf(const Topic& topic, const SessionGraph& graph);

/// Whether a replay publishes a channel in place of its publisher: whatever the other nodes
/// answered, as far as planners were given it.
bool replayed(const Channel& channel, const SessionGraph& graph);

/// Who answers on a topic, for messages to people: "cbv_planner_node" or the user's own ego
/// planner.
std::string answererOf(const Topic& topic, const SessionGraph& graph);

/// Whether a node of that part listens to a channel in such a session.
bool listensTo(const Channel& channel, Party party, const SessionGraph& graph);

/// Channels that a decision needs before it is complete for a node of that part.
using ChannelSet = std::set<ChannelId>;
ChannelSet awaitedBy(Party party, const SessionGraph& graph);

/// Why a message cannot be what its topic holds (another slot than the topic's, a selection that
/// names more CBVs than slots or one twice); empty when it can.
std::string unusable(const AnyMessage& message, const Topic& topic, const SessionGraph& graph);

/// Throws std::logic_error unless a channel's messages are of the type.
void requireType(ChannelId id, const std::type_index& type);

// The table of channels as documentation shows it.

/// A Markdown table, one line a channel, with a line break at the end. Absolute topic names are
/// those that a session without a namespace has.
std::string channelTable();

}  // namespace cdiff::ros
