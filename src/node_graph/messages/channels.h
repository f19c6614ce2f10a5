// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <typeindex>
#include <utility>
#include <vector>

#include "node_graph/bags/bag_reader.h"
#include "node_graph/lockstep/message_gate.h"
#include "node_graph/messages/traffic_conversions.h"
#include "node_graph/session_graph.h"
#include "ros/message_traits.h"
#include "rosbag/bag.h"

namespace cdiff::node_graph {

/// A message of some type; the channel that it came on determines the type.
using AnyMessage = boost::shared_ptr<const void>;
/// Takes a message and returns why it cannot be used; empty when it can.
using TakeMessage = std::function<std::string(const AnyMessage&)>;

/// The types of messages as values, so that a table can name them: how a message of a type is
/// published, taken, written to a bag and read from one. Every such message is kept as AnyMessage.
struct MessageType {
  std::type_index type;
  std::string name;    ///< "e2e_cdiff/Rollout"
  std::string md5sum;  ///< MD5 sum of the definition
  /// Throws InputError when the bytes do not match its type.
  AnyMessage (*decode)(const BagMessage& message);
  void (*write)(rosbag::Bag& bag, const std::string& topic, const ros::Time& stamp,
                const AnyMessage& message);
  ros::Publisher (*advertise)(Connections& connections, ros::NodeHandle& node,
                              const std::string& topic, const std::vector<std::string>& nodes,
                              bool latched);
  void (*publish)(const ros::Publisher& publisher, const AnyMessage& message);
  ros::Subscriber (*subscribe)(MessageGate& gate, ros::NodeHandle& node, const std::string& topic,
                               const std::vector<std::string>& publishers, const TakeMessage& take);
  /// Tick that the message is of; its stamp where it has no tick or the tick 0, and nullopt where
  /// that is zero, too.
  std::optional<std::uint64_t> (*tick)(const AnyMessage& message, double simulation_step);
  /// Slot that the message names; nullopt where it names none.
  std::optional<int> (*slot)(const AnyMessage& message);
};

/// A message as what it is; the caller knows its type.
template <class Message>
boost::shared_ptr<const Message> messageAs(const AnyMessage& message) {
  return boost::static_pointer_cast<const Message>(message);
}

template <class Message>
boost::shared_ptr<const Message> shared(Message message) {
  return boost::make_shared<const Message>(std::move(message));
}

namespace detail {

/// Whether a message type has a field `tick`.
template <class Message, class = void>
struct HasTick : std::false_type {};
template <class Message>
struct HasTick<Message, std::void_t<decltype(std::declval<Message>().tick)>> : std::true_type {};
/// Whether a message type has a field `slot`.
template <class Message, class = void>
struct HasSlot : std::false_type {};
template <class Message>
struct HasSlot<Message, std::void_t<decltype(std::declval<Message>().slot)>> : std::true_type {};
/// Whether a message type has a field `header`.
template <class Message, class = void>
struct HasHeader : std::false_type {};
template <class Message>
struct HasHeader<Message, std::void_t<decltype(std::declval<Message>().header)>> : std::true_type {
};

template <class Message>
std::optional<std::uint64_t> tickOf(const AnyMessage& any, double simulation_step) {
  const Message& message = *static_cast<const Message*>(any.get());
  if constexpr (HasTick<Message>::value) {
    if (message.tick != 0) return message.tick;
  }
  if constexpr (HasHeader<Message>::value) {
    if (!message.header.stamp.isZero()) return nearestTick(message.header.stamp, simulation_step);
  }
  return std::nullopt;
}

/// A message as a bag holds it: without the number that a connection between processes gave it.
template <class Message>
boost::shared_ptr<const Message> unnumbered(const AnyMessage& any) {
  const auto message = messageAs<Message>(any);
  if constexpr (HasHeader<Message>::value) {
    if (message->header.seq != 0) {
      Message copy = *message;
      copy.header.seq = 0;
      return shared(std::move(copy));
    }
  }
  return message;
}

template <class Message>
std::optional<int> slotOf(const AnyMessage& any) {
  if constexpr (HasSlot<Message>::value) return static_cast<const Message*>(any.get())->slot;
  return std::nullopt;
}

}  // namespace detail

template <class Message>
const MessageType& messageType() {
  static const MessageType type = {
      typeid(Message),
      ros::message_traits::DataType<Message>::value(),
      ros::message_traits::MD5Sum<Message>::value(),
      [](const BagMessage& message) -> AnyMessage { return decode<Message>(message); },
      [](rosbag::Bag& bag, const std::string& topic, const ros::Time& stamp,
         const AnyMessage& message) {
        bag.write(topic, stamp, detail::unnumbered<Message>(message));
      },
      [](Connections& connections, ros::NodeHandle& node, const std::string& topic,
         const std::vector<std::string>& nodes,
         bool latched) { return connections.advertise<Message>(node, topic, nodes, latched); },
      [](const ros::Publisher& publisher, const AnyMessage& message) {
        publisher.publish(messageAs<Message>(message));
      },
      [](MessageGate& gate, ros::NodeHandle& node, const std::string& topic,
         const std::vector<std::string>& publishers, const TakeMessage& take) {
        return gate.subscribe<Message>(node, topic, publishers,
                                       [take](const auto& message) { return take(message); });
      },
      &detail::tickOf<Message>,
      &detail::slotOf<Message>};
  return type;
}

// The table of channels: one row per topic of a session, from which publishers, listeners, the
// recorder, the bag reader, the replay, the book-keeping of the lockstep and docs/ros_api.md
// follow. A topic's name stands in channels.cpp and nowhere else.

/// In the order of the table, which is the order within a tick of a bag.
enum class ChannelId {
  kClock,
  kHeartbeat,
  kSession,
  kEgoRoute,
  kTraffic,
  kDecisionRecord,
  kSelection,
  kEgoControl,
  kEgoAckermann,
  kEgoTrajectory,
  kEgoVelocity,
  kCbvControl,
  kCbvRollout,
  kGuidance,
  kEgoImage,
  kEgoCameraInfo,
  kCbvImage,
  kCbvCameraInfo,
  kMetrics,
  kTransforms,
  kEgoOdometry,
  kCbvOdometry,
  kCbvTtc,
  kCbvGap,
  kCbvScore,
  kEgoObjects,
  kEgoObjectMarkers,
  kEgoScan,
  kEgoPoints,
  kTickAck,
  kMarkers,
  kMapMarkers,
  kFrontView,
  kRolloutMarkers,
  kPerceptionMarkers
};

/// Whose topic it is.
enum class Scope {
  kSession,  ///< one topic
  kEgo,      ///< one topic, of the ego
  kSlot      ///< a topic for each slot of a CBV: K of its name stands for the slot
};

/// What the messages of a channel are for.
enum class Use {
  kSetUp,    ///< describes the session; a bag starts with it
  kTick,     ///< the snapshot that makes a tick
  kAnswer,   ///< belongs to a tick; observers collect it, a replay reads it back
  kReport,   ///< belongs to a tick; the recorder collects it, nothing is computed from it
  kCommand,  ///< of an external ego; the simulator turns it into the ego's control
  kOther     ///< for tools and people, or of the nodes among themselves
};

/// What of a channel a decision needs before it is complete for a node that listens to it.
enum class Need {
  kNothing,
  kDecision,  ///< a message
  kVehicle,   ///< one of each vehicle (of the scope) that the decision asks a planner for
  kSight,     ///< the same, except of vehicles whose planner answered with a fault
  kAnyCbv,    ///< a message where there is a CBV to drive
  kRecord     ///< a message, which then says what else came
};

/// When a bag holds it.
enum class Recorded { kNever, kOnce, kTick, kDecision };

/// A property of a session, with a text for people; an empty text for what always holds.
struct Condition {
  const char* text;
  bool (*holds)(const SessionGraph& graph);
};

/// A party that takes a topic's messages, and in which sessions.
struct Listener {
  Party party;
  Condition when;
};

struct Answer;
class TickMessages;
struct TickValues;
struct TickReading;

struct Topic;

/// From the values of a tick to its message of a topic; nullptr where there is none.
using MakeMessage = AnyMessage (*)(const TickValues& values, const Topic& topic);
/// From a message of a topic into the answer for one vehicle.
struct TakenMessage {
  const AnyMessage& message;
  const Topic& topic;
};
using TakeAnswer = void (*)(const TakenMessage& taken, const TickReading& reading, Answer& answer);
/// A message for tools that repeats what other messages of the tick contain.
using DeriveMessage = AnyMessage (*)(const TickMessages& tick, const TickReading& reading,
                                     const Topic& topic);

/// One row of the table of channels: a topic, its message, who publishes and takes it, and how it
/// is converted.
struct Channel {
  ChannelId id;
  const char* name;  ///< relative to the session's namespace, or absolute
  Scope scope;
  const MessageType& type;
  bool latched;
  Use use;
  Party publisher;
  Condition published;              ///< in which sessions
  std::vector<Listener> listeners;  ///< whom the publisher waits for before the first tick
  Need need;
  Recorded recorded;
  MakeMessage make;         ///< may be nullptr, as the two below
  TakeAnswer take;          ///< set for messages that carry part of a vehicle's answer
  DeriveMessage derive;     ///< set for messages that are made from others
  const char* help;         ///< a sentence
  bool per_camera = false;  ///< a topic for each camera of a rig: the row names that of the front
                            ///< camera, another camera C has camera_C in its place
};

/// The table, by ChannelId.
const std::vector<Channel>& channels();
const Channel& channel(ChannelId id);

}  // namespace cdiff::node_graph
