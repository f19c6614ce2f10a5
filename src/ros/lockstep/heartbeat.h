// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "ros/ros.h"

namespace cdiff::ros {

// The traffic simulator's sign of life once a second of wall time, and how the other nodes judge
// its absence.

/// Publishes the topic heartbeat from a thread of its own, so that neither a long tick nor a long
/// wait of the node looks like its death.
class HeartbeatPublisher {
 public:
  /// Publishes from now on. After `timeout` [s] of silence listeners take this node for dead.
  HeartbeatPublisher(::ros::NodeHandle& node, double timeout);
  ~HeartbeatPublisher();
  HeartbeatPublisher(const HeartbeatPublisher&) = delete;
  HeartbeatPublisher& operator=(const HeartbeatPublisher&) = delete;

 private:
  void publishUntilStopped(double timeout);

  ::ros::Publisher publisher_;
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

}  // namespace cdiff::ros
