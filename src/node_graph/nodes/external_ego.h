// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "e2e_cdiff/ControlAction.h"
#include "e2e_cdiff/TrafficSnapshot.h"
#include "node_graph/messages/topics.h"
#include "planning/ego_commands.h"
#include "session/session_setup.h"

namespace cdiff::node_graph {

/// What became of a message of the ego's planner.
struct EgoAnswer {
  AnyMessage control;   ///< ControlAction; nullptr where there is none to take
  std::string refused;  ///< why the message counts for nothing; empty when it counts
};

/// A user's own node in the place of the ego's planner, as the traffic simulator sees it: on which
/// topic its commands come, how each becomes a ControlAction, and how long it took. A command that
/// the vehicle cannot follow becomes full braking with a fault.
class ExternalEgo {
 public:
  ExternalEgo(const session::SessionSetup& setup, const SessionGraph& graph);

  /// The channel of ego.command.
  Topic topic() const { return topic_; }
  /// A tick is out.
  void published(const traffic::TrafficSnapshot& snapshot);
  /// Takes a message of topic(), whose type is that of the channel.
  EgoAnswer take(const AnyMessage& message);

 private:
  using Clock = std::chrono::steady_clock;
  std::optional<std::uint64_t> tickOf(const AnyMessage& message) const;
  traffic::ControlAction follow(const AnyMessage& message);
  AnyMessage timed(::e2e_cdiff::ControlAction control, std::uint64_t tick) const;

  Topic topic_;
  bool paced_;
  double simulation_step_;  ///< [s]
  planning::EgoCommands commands_;
  traffic::TrafficSnapshot newest_;
  std::map<std::uint64_t, Clock::time_point> published_at_;  ///< of late ticks
  std::optional<std::uint64_t> answered_;                    ///< newest tick with a command
};

/// Which nodes publish commands of the ego that the session does not listen to: on the topic of
/// another ego.command, or with another type. A sentence; empty when there are none, or when the
/// ROS master does not answer.
std::string misdirectedCommands(const SessionGraph& graph);

}  // namespace cdiff::node_graph
