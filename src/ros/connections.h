// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Which of the nodes that a publisher counts on are connected to it, by node name:
/// `getNumSubscribers()` counts processes, whoever they are. Fed by roscpp's connection callbacks,
/// in the thread that spins.
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "ros/ros.h"

namespace cdiff::ros {

class Connections {
 public:
  Connections() = default;
  Connections(const Connections&) = delete;
  Connections& operator=(const Connections&) = delete;

  /// From now on each of `nodes` is counted on at `topic`.
  void expect(const std::string& topic, const std::vector<std::string>& nodes);
  /// A node (full name) connected to or left a topic.
  void connected(const std::string& topic, const std::string& node);
  void disconnected(const std::string& topic, const std::string& node);

  /// "node does not listen to topic yet", one text each; empty when all are there.
  std::vector<std::string> missing() const;
  /// Nodes that were counted on, came and left, in the order they left.
  const std::vector<std::string>& left() const { return left_; }
  bool hasLeft(const std::string& node) const;
  /// Whether a node (full name) listens to any of the topics, counted on or not.
  bool listens(const std::string& node) const { return links_.count(node) > 0; }
  /// Whether it did and does not any more: its process has ended, or it has left. roscpp counts a
  /// publisher that was killed among `getNumPublishers()` for ever; the end of its connections as a
  /// listener is what shows.
  bool stoppedListening(const std::string& node) const {
    return once_.count(node) > 0 && !listens(node);
  }

  /// Advertises a topic and counts on `nodes` to listen. This object must outlive the publisher.
  template <class Message>
  ::ros::Publisher advertise(::ros::NodeHandle& node_handle, const std::string& topic,
                             const std::vector<std::string>& nodes, bool latch = false) {
    expect(topic, nodes);
    const auto connect = [this, topic](const ::ros::SingleSubscriberPublisher& peer) {
      connected(topic, peer.getSubscriberName());
    };
    const auto disconnect = [this, topic](const ::ros::SingleSubscriberPublisher& peer) {
      disconnected(topic, peer.getSubscriberName());
    };
    return node_handle.advertise<Message>(topic, kQueueSize, connect, disconnect, {}, latch);
  }

 private:
  static constexpr std::uint32_t kQueueSize = 1000;
  std::map<std::pair<std::string, std::string>, int>
      counts_;  ///< connections per topic and node counted on
  std::vector<std::string> left_;
  std::map<std::string, int> links_;  ///< connections by full node name, where there are any
  std::set<std::string> once_;        ///< full names of all nodes that ever had one
};

/// Name of a node without its namespace.
std::string baseName(const std::string& node);

}  // namespace cdiff::ros
