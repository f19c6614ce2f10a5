// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "e2e_cdiff/ControlAction.h"
#include "e2e_cdiff/TrafficSnapshot.h"
#include "ros/ros.h"
#include "sensor_msgs/Image.h"

namespace cdiff::node_graph {

/// Which of the nodes that a publisher counts on are connected to it, by node name:
/// `getNumSubscribers()` counts processes, whoever they are. Fed by roscpp's connection callbacks,
/// in the thread that spins.
class Connections {
 public:
  Connections() = default;
  Connections(const Connections&) = delete;
  Connections& operator=(const Connections&) = delete;

  /// From now on each of `nodes` is counted on at `topic`. Threads of this process are connected
  /// from the moment they subscribe, and are not counted.
  void expect(const std::string& topic, const std::vector<std::string>& nodes);
  /// A node (full name) connected to or left a topic.
  void connected(const std::string& topic, const std::string& node);
  void disconnected(const std::string& topic, const std::string& node);

  /// "node does not listen to topic yet", one text each; empty when all are there.
  std::vector<std::string> missing() const;
  /// Nodes that were counted on, came and left, in the order they left; where nodes are threads of
  /// this process, all that left.
  std::vector<std::string> left() const;
  bool hasLeft(const std::string& node) const;
  /// Whether a node (full name) listens to any of the topics, counted on or not.
  bool listens(const std::string& node) const { return links_.count(node) > 0; }
  /// Whether it did and does not any more: its process has ended, or it has left. roscpp counts a
  /// publisher that was killed among `getNumPublishers()` forever; the end of its connections as a
  /// listener is what shows.
  bool stoppedListening(const std::string& node) const {
    return once_.count(node) > 0 && !listens(node);
  }

  /// Advertises a topic and counts on `nodes` to listen. This object must outlive the publisher.
  template <class Message>
  ros::Publisher advertise(ros::NodeHandle& node_handle, const std::string& topic,
                           const std::vector<std::string>& nodes, bool latch = false) {
    expect(topic, nodes);
    const auto connect = [this, topic](const ros::SingleSubscriberPublisher& peer) {
      connected(topic, peer.getSubscriberName());
    };
    const auto disconnect = [this, topic](const ros::SingleSubscriberPublisher& peer) {
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

/// Reads the messages of a topic's publishers (full names; none: of any sender). Another's becomes
/// an empty message, its bytes unread: a list's length that is none makes roscpp fill memory for
/// seconds. Nodelets of one process share what one of them has read, so it keeps no count; a
/// foreign nodelet that listened first reads as roscpp does.
template <class Message>
class MessageReader
    : public ros::SubscriptionCallbackHelperT<const ros::MessageEvent<const Message>&> {
 public:
  using Base = ros::SubscriptionCallbackHelperT<const ros::MessageEvent<const Message>&>;

  MessageReader(std::vector<std::string> publishers, const typename Base::Callback& callback)
      : Base(callback), publishers_(std::move(publishers)) {}

  ros::VoidConstPtr deserialize(
      const ros::SubscriptionCallbackHelperDeserializeParams& params) override {
    const auto caller = params.connection_header->find("callerid");
    const bool known = publishers_.empty() || (caller != params.connection_header->end() &&
                                               std::find(publishers_.begin(), publishers_.end(),
                                                         caller->second) != publishers_.end());
    if (!known) return boost::make_shared<Message>();
    return Base::deserialize(params);
  }

 private:
  std::vector<std::string> publishers_;
};

/// Who may send what to a node: each topic of a session has one publisher, known by roscpp's caller
/// id, and no message is of a tick that has not been. Everything else is ignored, counted and
/// reported. (A node that takes another's name is not noticed: ROS 1 has no identities.)
class MessageGate {
 public:
  /// Takes a sentence that names sender, topic and reason.
  using Report = std::function<void(const std::string& text)>;

  /// Called at the first message that is refused of a sender on a topic, at the 10th, the 100th ...
  void setReport(Report report) { report_ = std::move(report); }
  /// Answers to later ticks are refused; until it is called none is. `simulation_step` [s] turns a
  /// stamp into a tick.
  void setNewestTick(std::uint64_t tick, double simulation_step) {
    newest_tick_ = tick;
    simulation_step_ = simulation_step;
  }

  /// Whether `caller` is one of `publishers` (full names); where there are none, whether it is the
  /// first that sent on `topic`. Refuses its message otherwise.
  bool admits(const std::string& topic, const std::vector<std::string>& publishers,
              const std::string& caller);
  /// Whether the tick has been; refuses the message otherwise.
  bool admitsTick(const std::string& topic, const std::string& caller, std::uint64_t tick);
  /// Counts and reports a message that is not used.
  void refuse(const std::string& topic, const std::string& caller, const std::string& why);
  /// "N messages of SENDER on TOPIC were ignored", one for each that was refused more than once.
  std::vector<std::string> totals() const;

  /// Full name of the node that `topic` is listened to, where any may send; empty before the first
  /// message.
  std::string firstSender(const std::string& topic) const {
    const auto found = first_.find(topic);
    return found == first_.end() ? std::string() : found->second;
  }

  /// Subscribes without delaying small messages (TCP_NODELAY). `callback` takes a shared pointer to
  /// a constant message that was admitted, and may answer why it cannot be used (a text, empty when
  /// it can). This object must outlive the subscriber.
  template <class Message, class Callback>
  ros::Subscriber subscribe(ros::NodeHandle& node_handle, const std::string& topic,
                            const std::vector<std::string>& publishers, Callback callback) {
    const auto take = [this, topic, publishers,
                       callback](const ros::MessageEvent<const Message>& event) {
      const std::string& caller = event.getPublisherName();
      const auto& message = event.getConstMessage();
      if (!admits(topic, publishers, caller) || !admitsTick(topic, caller, tickOf(*message)))
        return;
      if constexpr (std::is_void_v<decltype(callback(message))>) {
        callback(message);
      } else {
        const std::string why = callback(message);
        if (!why.empty()) refuse(topic, caller, why);
      }
    };
    constexpr std::uint32_t kQueueSize = 1000;
    ros::SubscribeOptions options(topic, kQueueSize, ros::message_traits::md5sum<Message>(),
                                  ros::message_traits::datatype<Message>());
    options.helper = boost::make_shared<MessageReader<Message>>(publishers, take);
    options.transport_hints = ros::TransportHints().tcpNoDelay();
    return node_handle.subscribe(options);
  }

 private:
  template <class Message>
  std::uint64_t tickOf(const Message& message) const {
    if constexpr (std::is_same_v<Message, ::e2e_cdiff::ControlAction>) {
      return message.tick != 0 ? message.tick : tickOf(message.header.stamp);
    } else if constexpr (std::is_same_v<Message, sensor_msgs::Image>) {
      return tickOf(message.header.stamp);
    } else if constexpr (std::is_same_v<Message, ::e2e_cdiff::TrafficSnapshot>) {
      return 0;  // it is what makes ticks be
    } else if constexpr (hasTick<Message>(0)) {
      return message.tick;
    } else {
      return 0;
    }
  }
  std::uint64_t tickOf(const ros::Time& stamp) const;
  template <class Message>
  static constexpr auto hasTick(int) -> decltype(std::declval<Message>().tick, true) {
    return true;
  }
  template <class Message>
  static constexpr bool hasTick(long) {
    return false;
  }

  Report report_;
  std::uint64_t newest_tick_ = UINT64_MAX;
  double simulation_step_ = 0.05;
  std::map<std::string, std::string> first_;  ///< sender by topic, where any may send
  std::map<std::pair<std::string, std::string>, std::uint64_t> refused_;  ///< by sender and topic
};

/// Full name of a node beside this one, as roscpp has it: that of the process where nodes share
/// one.
std::string siblingNode(const std::string& base_name);
std::vector<std::string> siblingNodes(const std::vector<std::string>& base_names);

}  // namespace cdiff::node_graph
