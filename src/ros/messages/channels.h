// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "ros/messages/message_type.h"
#include "ros/session_graph.h"

namespace cdiff::ros {

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
  kTickAck,
  kMarkers,
  kMapMarkers,
  kRolloutMarkers
};

/// Whose topic it is.
enum class Scope {
  kSession,  ///< one topic
  kEgo,      ///< one topic, of the ego
  kSlot      ///< a topic for each slot of a CBV: K of its name stands for the slot
};

/// What the messages of a channel are for.
enum class Use {
  kSetUp,   ///< describes the session; a bag starts with it
  kTick,    ///< the snapshot that makes a tick
  kAnswer,  ///< belongs to a tick; observers collect it, a replay reads it back
  kReport,  ///< belongs to a tick; the recorder collects it, nothing is computed from it
  kOther    ///< for tools and people, or of the nodes among themselves
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

/// From the values of a tick to its message of a slot; nullptr where there is none.
using MakeMessage = AnyMessage (*)(const TickValues& values, int slot);
/// From a message into the answer for one vehicle.
using TakeAnswer = void (*)(const AnyMessage& message, const TickReading& reading, Answer& answer);
/// A message for tools that repeats what other messages of the tick contain.
using DeriveMessage = AnyMessage (*)(const TickMessages& tick, const TickReading& reading,
                                     int slot);

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
  MakeMessage make;      ///< may be nullptr, as the two below
  TakeAnswer take;       ///< set for messages that carry part of a vehicle's answer
  DeriveMessage derive;  ///< set for messages that are made from others
  const char* help;      ///< a sentence
};

/// The table, by ChannelId.
const std::vector<Channel>& channels();
const Channel& channel(ChannelId id);

}  // namespace cdiff::ros
