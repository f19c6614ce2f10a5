// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Stands in for the traffic simulator beside one real node: publishes a session and snapshots,
/// answers for everybody else, and collects what the node sends. The test program runs under the
/// simulator's name.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "e2e_cdiff/TickAck.h"
#include "node_graph/lockstep/message_gate.h"
#include "node_graph/messages/session_conversions.h"
#include "node_graph/messages/topics.h"
#include "node_graph/messages/traffic_conversions.h"
#include "ros/callback_queue.h"
#include "sensor_msgs/CameraInfo.h"
#include "sensor_msgs/Image.h"

namespace cdiff::test {

class FakeSimulator {
 public:
  /// The session crossing_left_turn, cameras shown (and a random model for the diffusion planner),
  /// with `node` as the only node that the session counts on; its files go to `results`.
  FakeSimulator(const std::string& node, const std::filesystem::path& results);

  /// Spins until `done` or 20 s of wall time; returns whether it is done.
  template <class Done>
  bool until(Done done) {
    const ros::WallTime limit = ros::WallTime::now() + ros::WallDuration(20.0);
    while (!done() && ros::WallTime::now() < limit) {
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.05));
    }
    return done();
  }
  /// The node has said that it is connected both ways, and hears us.
  bool ready();
  /// Whether the node has sent an acknowledgement of this kind, of this tick.
  bool acknowledged(std::uint8_t kind, std::uint64_t tick) const;

  /// Ego at the start of its route and one background vehicle "bg_0" 30 m ahead of it.
  traffic::TrafficSnapshot snapshot(std::uint64_t tick) const;
  void publish(const traffic::TrafficSnapshot& snapshot) {
    traffic_.publish(
        boost::make_shared<const node_graph::msgs::TrafficSnapshot>(node_graph::toMsg(snapshot)));
  }
  /// "bg_0" in slot 0, on the ego's own route.
  cbv::CbvSelection selection(std::uint64_t tick) const;
  /// What the other nodes would answer to a snapshot: selection, controls of ego and CBV, an empty
  /// rollout.
  void answer(const traffic::TrafficSnapshot& snapshot);
  void publishImage(const sensor_msgs::Image& image);  ///< of slot 0
  void publishSelection(const traffic::TrafficSnapshot& snapshot);

  const session::SessionSetup& setup() const { return setup_; }
  // What came, by tick.
  std::map<std::uint64_t, node_graph::msgs::CbvSelection::ConstPtr> selections;
  std::map<std::uint64_t, node_graph::msgs::ControlAction::ConstPtr> ego_controls;
  std::map<std::uint64_t, node_graph::msgs::ControlAction::ConstPtr> cbv_controls;
  std::map<std::uint64_t, node_graph::msgs::Rollout::ConstPtr> rollouts;
  std::map<std::uint64_t, node_graph::msgs::MetricReport::ConstPtr> reports;
  std::map<std::uint64_t, node_graph::msgs::GuidanceReport::ConstPtr> guidance;
  std::map<std::uint64_t, sensor_msgs::Image::ConstPtr> images;  ///< of slot 0
  std::map<std::uint64_t, sensor_msgs::Image::ConstPtr> ego_images;
  std::map<std::uint64_t, sensor_msgs::CameraInfo::ConstPtr> infos;  ///< of slot 0

 private:
  void publishSession(const std::filesystem::path& results);
  void answerForOthers(const std::string& node);
  void listen();

  session::SessionSetup setup_;
  node_graph::SessionGraph graph_;
  node_graph::Connections connections_;
  ros::NodeHandle node_;
  ros::Publisher session_;
  ros::Publisher route_;
  ros::Publisher traffic_;
  std::map<node_graph::Topic, ros::Publisher> others_;  ///< topics of nodes that do not take part
  std::vector<ros::Subscriber> inputs_;
  std::vector<node_graph::msgs::TickAck> acks_;
};

}  // namespace cdiff::test
