// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <set>
#include <string>
#include <tuple>
#include <typeindex>
#include <vector>

#include "node_graph/messages/channels.h"

namespace cdiff::node_graph {

// The topics of one session, who publishes them and who listens: the table of channels (channels.h)
// applied to a session's nodes and slots (SessionGraph).

/// One topic: a channel and, where the channel has one topic per slot or camera, the slot and the
/// camera.
struct Topic {
  Topic(ChannelId channel_id, int of_slot = kEgoSlot,  // NOLINT
        const std::string& of_camera = rendering::kFrontCamera)
      : id(channel_id), slot(of_slot), camera(of_camera) {}

  ChannelId id;
  int slot;            ///< kEgoSlot unless the channel has a topic per slot
  std::string camera;  ///< "front" unless the channel has a topic per camera

  const Channel& row() const { return channel(id); }
  /// Name relative to the session's namespace; absolute names start with a slash.
  std::string name() const;
  bool operator==(const Topic& other) const {
    return id == other.id && slot == other.slot && camera == other.camera;
  }
  bool operator<(const Topic& other) const {
    return std::tie(id, slot, camera) < std::tie(other.id, other.slot, other.camera);
  }
};

/// Topics of the vehicle in a slot: its commands, the images of a camera and their intrinsics.
/// kEgoSlot: the ego's.
Topic controlOf(int slot);
Topic imageOf(int slot, const std::string& camera = rendering::kFrontCamera);
Topic cameraInfoOf(int slot, const std::string& camera = rendering::kFrontCamera);

/// The topic on which the ego's planner commands: that of ego.command where the ego is external.
Topic egoCommandOf(const SessionGraph& graph);

/// The topics of a channel for one vehicle: one, or one per camera of its rig.
std::vector<Topic> topicsOfSlot(const Channel& channel, int slot, const session::VehicleRigs& rigs);
/// The topics of a channel in a session with `max_cbv` slots.
std::vector<Topic> topicsOf(const Channel& channel, int max_cbv, const session::VehicleRigs& rigs);
std::vector<Topic> topicsOf(const Channel& channel, const SessionGraph& graph);

std::vector<std::string> namesOf(const std::vector<Topic>& topics);

/// Nodes that listen to a topic in this session, by name; a publisher waits for them before the
/// first tick.
std::vector<std::string> listeners(const Topic& topic, const SessionGraph& graph);

/// The nodes, without namespace, whose messages are accepted on a topic: its publisher, and the
/// traffic simulator, under whose name a replay publishes. Empty where the first sender is
/// accepted, whoever it is (the controls of external planners).
std::vector<std::string> publishersOf(const Topic& topic, const SessionGraph& graph);

/// Whether a replay publishes a channel in place of its publisher: the answers of other nodes, and
/// the images that planners were given.
bool replayed(const Channel& channel, const SessionGraph& graph);

/// Name for error texts of the node that answers on a topic: "cbv_planner_node", or "the external
/// ego planner", or "the external CBV planner".
std::string answererOf(const Topic& topic, const SessionGraph& graph);

/// Whether a channel's last message waits for who subscribes later. What comes at every tick or
/// decision does not where nodes share a process: roscpp would serialize each message for nobody.
bool isLatched(const Channel& channel);

/// Whether the node that plays a part in the session listens to a channel.
bool listensTo(const Channel& channel, Party party, const SessionGraph& graph);

/// Channels whose messages the node that plays a part waits for at a decision.
using ChannelSet = std::set<ChannelId>;
ChannelSet awaitedBy(Party party, const SessionGraph& graph);

/// Why a message must be refused on a topic (it names another slot than the topic's, or is a
/// selection with more CBVs than slots or with one twice); empty when it is accepted.
std::string unusable(const AnyMessage& message, const Topic& topic, const SessionGraph& graph);

/// Throws std::logic_error unless the messages of a channel have this type.
void requireType(ChannelId id, const std::type_index& type);

/// The table of channels for docs/ros_api.md: Markdown, one line a channel, with a line break at
/// the end. Topic names are those of a session without a namespace.
std::string channelTable();

}  // namespace cdiff::node_graph
