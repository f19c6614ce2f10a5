// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// A node that is no part of the session and sends on all its topics: commands, a selection of
// 20,000 vehicles, answers to ticks that have not been, acknowledgements and an error in another's
// name, a snapshot that ends the session, another session, images from the future.
#include <limits>

#include "e2e_cdiff/CbvSelection.h"
#include "e2e_cdiff/ControlAction.h"
#include "e2e_cdiff/MetricReport.h"
#include "e2e_cdiff/Rollout.h"
#include "e2e_cdiff/SessionInfo.h"
#include "e2e_cdiff/TickAck.h"
#include "e2e_cdiff/TrafficSnapshot.h"
#include "ros/ros.h"
#include "sensor_msgs/Image.h"

namespace {

namespace msgs = e2e_cdiff;

class Rogue {
 public:
  Rogue() {
    advertise<msgs::CbvSelection>("/cbv/selection");
    advertise<msgs::ControlAction>("/ego/control");
    advertise<msgs::ControlAction>("/cbv_0/control");
    advertise<msgs::Rollout>("/cbv_0/rollout");
    advertise<msgs::TickAck>("/tick_ack");
    advertise<msgs::TrafficSnapshot>("/traffic");
    advertise<msgs::SessionInfo>("/session");
    advertise<msgs::MetricReport>("/metrics");
    advertise<sensor_msgs::Image>("/cbv_0/camera/image_raw");
    const boost::function<void(const ros::MessageEvent<const msgs::TrafficSnapshot>&)> disturb =
        [this](const auto& event) {
          if (event.getPublisherName() != ros::this_node::getName())
            disturbAt(event.getMessage()->tick);
        };
    traffic_ = node_.subscribe<const ros::MessageEvent<const msgs::TrafficSnapshot>&>(
        "/traffic", 100, disturb, {}, ros::TransportHints().tcpNoDelay());
  }

 private:
  template <class Message>
  void advertise(const std::string& topic) {
    outputs_[topic] = node_.advertise<Message>(topic, 100);
  }

  /// For this tick, where the true answer may come second, for the next ones and for one far away.
  void disturbAt(std::uint64_t tick) {
    if (tick == 0) return;
    for (const std::uint64_t at : {tick, tick + 1, tick + 2, std::uint64_t{1} << 40})
      sendAnswers(at);
    sendSelection(tick % 20 == 0 ? 20000 : 2, tick + 1);
    sendAck(msgs::TickAck::ACKNOWLEDGED, tick);
    sendAck(msgs::TickAck::ERROR, tick);
    msgs::TrafficSnapshot end;
    end.tick = tick + 1;
    end.status = msgs::TrafficSnapshot::COMPLETED;
    outputs_.at("/traffic").publish(end);
    msgs::SessionInfo session;
    session.scenario_yaml = "max_cbv: 16\n";
    outputs_.at("/session").publish(session);
  }

  void sendAnswers(std::uint64_t tick) {
    msgs::ControlAction action;
    action.tick = tick;
    action.throttle = 1.0;
    action.steer = 1.0;
    for (const int slot : {-1, 0}) {
      action.slot = slot;
      outputs_.at(slot < 0 ? "/ego/control" : "/cbv_0/control").publish(action);
    }
    sendSelection(0, tick);
    msgs::Rollout rollout;
    rollout.tick = tick;
    outputs_.at("/cbv_0/rollout").publish(rollout);
    msgs::MetricReport report;
    report.tick = tick;
    outputs_.at("/metrics").publish(report);
    sensor_msgs::Image image;
    image.header.stamp = ros::Time(std::min(0.05 * static_cast<double>(tick), 4e9));
    outputs_.at("/cbv_0/camera/image_raw").publish(image);
  }

  /// All in slot 0.
  void sendSelection(std::size_t assignments, std::uint64_t tick) {
    msgs::CbvSelection selection;
    selection.tick = tick;
    selection.assignments.resize(assignments);
    outputs_.at("/cbv/selection").publish(selection);
  }

  void sendAck(std::uint8_t kind, std::uint64_t tick) {
    msgs::TickAck ack;
    ack.node = "metrics_node";
    ack.kind = kind;
    ack.tick = tick;
    outputs_.at("/tick_ack").publish(ack);
  }

  ros::NodeHandle node_;
  std::map<std::string, ros::Publisher> outputs_;
  ros::Subscriber traffic_;
};

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "rogue_node");
  Rogue rogue;
  ros::spin();
}
