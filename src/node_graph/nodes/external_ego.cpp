// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/nodes/external_ego.h"

#include <cmath>
#include <vector>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "node_graph/messages/command_conversions.h"
#include "node_graph/messages/traffic_conversions.h"
#include "ros/ros.h"

namespace cdiff::node_graph {
namespace {

constexpr std::size_t kTimedTicks = 400;  // kept for latencies

/// "ackermann" of ego/ackermann: the value of ego.command for which a topic is listened to.
std::string commandOf(const Channel& row) {
  const std::string name = row.name;
  return name.substr(name.rfind('/') + 1);
}

}  // namespace

ExternalEgo::ExternalEgo(const session::SessionSetup& setup, const SessionGraph& graph)
    : topic_(egoCommandOf(graph)),
      paced_(graph.paced),
      simulation_step_(setup.options().simulation_step),
      commands_(setup.options().vehicle, setup.options().decision_period) {}

void ExternalEgo::published(const traffic::TrafficSnapshot& snapshot) {
  newest_ = snapshot;
  published_at_[snapshot.tick] = Clock::now();
  if (published_at_.size() > kTimedTicks) published_at_.erase(published_at_.begin());
}

/// A velocity says nothing of ticks: it answers the newest one. So do others where the wall clock
/// rules. nullopt where the message must say its tick and does not.
std::optional<std::uint64_t> ExternalEgo::tickOf(const AnyMessage& message) const {
  const auto tick = topic_.row().type.tick(message, simulation_step_);
  if (tick) return tick;
  const bool newest = paced_ || topic_.id == ChannelId::kEgoVelocity;
  if (newest || newest_.tick == 0) return newest_.tick;
  return std::nullopt;
}

EgoAnswer ExternalEgo::take(const AnyMessage& message) {
  const std::optional<std::uint64_t> tick = tickOf(message);
  if (!tick) {
    return {nullptr,
            "it has neither tick nor stamp, so it counts for tick 0, and the session is at tick " +
                std::to_string(newest_.tick) +
                "; copy tick or header.stamp from the /traffic message that it answers"};
  }
  if (*tick > newest_.tick)
    return {nullptr, "it answers tick " + std::to_string(*tick) + ", which has not been"};
  if (topic_.id == ChannelId::kEgoControl)
    return {timed(*messageAs<msgs::ControlAction>(message), *tick), ""};
  const bool again = answered_ && *tick <= *answered_;  // the first one of a tick counts
  if (again || (!paced_ && !newest_.decision_tick)) return {};
  answered_ = tick;
  msgs::ControlAction control;
  traffic::ControlAction action = traffic::ControlAction::failSafe();
  try {
    action = follow(message);
  } catch (const core::InputError& error) {
    control.fault = topic_.name() + ": " + error.what() + "; full braking instead";
  }
  control.slot = kEgoSlot;
  control.throttle = action.throttle;
  control.steer = action.steer;
  control.brake = action.brake;
  return {timed(control, *tick), ""};
}

/// The wall time from the tick's publication to the command, where the planner does not say how
/// long it planned.
AnyMessage ExternalEgo::timed(msgs::ControlAction control, std::uint64_t tick) const {
  control.tick = tick;
  const auto out = published_at_.find(tick);
  const bool said = std::isfinite(control.planner_latency_ms) && control.planner_latency_ms > 0.0;
  if (!said && out != published_at_.end()) {
    control.planner_latency_ms =
        std::chrono::duration<double, std::milli>(Clock::now() - out->second).count();
  }
  return shared(std::move(control));
}

traffic::ControlAction ExternalEgo::follow(const AnyMessage& message) {
  const traffic::Vehicle* ego = newest_.ego();
  if (ego == nullptr) throw core::InputError("the session has no ego any more");
  if (topic_.id == ChannelId::kEgoAckermann)
    return commands_.follow(*ego, fromMsg(*messageAs<msgs::AckermannCommand>(message)));
  if (topic_.id == ChannelId::kEgoVelocity)
    return commands_.follow(*ego, fromMsg(*messageAs<geometry_msgs::Twist>(message)));
  const auto path = messageAs<nav_msgs::Path>(message);
  return commands_.follow(*ego, newest_.time, trajectoryFrom(*path));
}

namespace {

/// Names of the nodes that publish a topic (full name), by the ROS master.
std::vector<std::string> publishersAtMaster(const std::string& topic) {
  XmlRpc::XmlRpcValue arguments;
  XmlRpc::XmlRpcValue answer;
  XmlRpc::XmlRpcValue state;
  arguments[0] = ros::this_node::getName();
  std::vector<std::string> nodes;
  if (!ros::master::execute("getSystemState", arguments, answer, state, false)) return nodes;
  for (int i = 0; i < state[0].size(); ++i) {
    if (std::string(state[0][i][0]) != topic) continue;
    for (int k = 0; k < state[0][i][1].size(); ++k) nodes.push_back(state[0][i][1][k]);
  }
  return nodes;
}

std::string published(const std::string& topic, const std::string& type) {
  return core::joinText(publishersAtMaster(topic), ", ") + " publishes " + topic + " (" + type +
         ")";
}

}  // namespace

std::string misdirectedCommands(const SessionGraph& graph) {
  ros::master::V_TopicInfo topics;
  if (!ros::master::getTopics(topics)) return "";
  const Topic wanted = egoCommandOf(graph);
  const std::string expected = "ego.command is " + graph.ego_command + ", which takes " +
                               wanted.row().type.name + " on " + ros::names::resolve(wanted.name());
  for (const ros::master::TopicInfo& topic : topics) {
    for (const Channel& row : channels()) {
      const bool command = row.id == ChannelId::kEgoControl || row.use == Use::kCommand;
      if (!command || topic.name != ros::names::resolve(row.name)) continue;
      const bool same = row.id == wanted.id;
      if (same && topic.datatype == row.type.name) continue;
      return published(topic.name, topic.datatype) + ", but " + expected +
             (same ? "" : "; for it set ego.command=" + commandOf(row));
    }
  }
  return "";
}

}  // namespace cdiff::node_graph
