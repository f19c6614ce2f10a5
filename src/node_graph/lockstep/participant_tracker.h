// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "e2e_cdiff/TickAck.h"
#include "ros/ros.h"

namespace cdiff::node_graph {

// The traffic simulator's sign of life once a second of wall time, and how the other nodes judge
// its absence.

/// Publishes the topic heartbeat from a thread of its own, so that neither a long tick nor a long
/// wait of the node looks like its death.
class HeartbeatPublisher {
 public:
  /// Publishes from now on. After `timeout` [s] of silence listeners take this node for dead.
  HeartbeatPublisher(ros::NodeHandle& node, double timeout);
  ~HeartbeatPublisher();
  HeartbeatPublisher(const HeartbeatPublisher&) = delete;
  HeartbeatPublisher& operator=(const HeartbeatPublisher&) = delete;

 private:
  void publishUntilStopped(const std::string& node, double timeout);

  ros::Publisher publisher_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stopping_ = false;
  std::thread thread_;  ///< last: it uses the others
};

/// How long a sender has been silent. Counts only the time that the listener itself was looking: a
/// listener that computed, or was stopped itself, has not listened meanwhile.
class SilenceWatch {
 public:
  /// A message came; the next is due within `timeout` [s].
  void heard(double timeout);
  /// A look at `now` [s of a steady clock], after what had come was handled. Returns whether the
  /// sender has been silent for longer than its timeout; never before it was first heard.
  bool silent(double now);
  double timeout() const { return timeout_; }
  bool everHeard() const { return timeout_ > 0.0; }

 private:
  static constexpr double kLongestLook = 0.5;  ///< [s] of silence that one look may add
  double timeout_ = 0.0;
  double silence_ = 0.0;
  double last_look_ = 0.0;
};

/// Ticks that metrics and recorder may be behind a traffic simulator that waits for answers. Enough
/// that one slow tick of theirs, such as the writing of a chunk of the bag, holds up nothing.
inline constexpr std::uint64_t kMostLag = 20;

/// What the traffic simulator knows about the other nodes from their TickAck messages: ready, last
/// tick acknowledged, finished, in error, when last heard.
class ParticipantTracker {
 public:
  /// Nodes that the session counts on, without namespace.
  explicit ParticipantTracker(const std::vector<std::string>& nodes);

  using Clock = std::chrono::steady_clock;
  /// Messages of nodes that the session does not count on are ignored.
  void note(const ::e2e_cdiff::TickAck& message, Clock::time_point now = Clock::now());

  /// A text for each node that is not ready, beginning with its name; those that were never heard
  /// first.
  std::vector<std::string> notReady() const;
  /// Observers that have not acknowledged this tick.
  std::vector<std::string> notAcknowledged(std::uint64_t tick) const;
  /// The latest tick that every observer has acknowledged; 0 before the first.
  std::uint64_t acknowledgedByAll() const;
  /// Observers that have not said that they are finished.
  std::vector<std::string> notFinished() const;
  bool finished(const std::string& node) const;
  /// Whether any message of the node has arrived.
  bool heard(const std::string& node) const;
  /// Nodes, sorted by name, that were heard earlier but not within `seconds` before `now`. A node
  /// that waits for others reports this every second; a silent one is computing, hangs or is
  /// stopped.
  std::vector<std::string> silent(double seconds, Clock::time_point now = Clock::now()) const;
  /// The first node that reported an error, and what it said.
  struct Error {
    std::string node;
    std::string text;
  };
  const std::optional<Error>& error() const { return error_; }

 private:
  struct Entry {
    bool ready = false;
    bool finished = false;
    std::string waiting_for;  ///< empty until the node has been heard
    std::optional<std::uint64_t> acknowledged;
    std::optional<Clock::time_point> heard_at;
  };
  std::map<std::string, Entry> entries_;
  std::optional<Error> error_;
};

}  // namespace cdiff::node_graph
