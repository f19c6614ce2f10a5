// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/nodes/scene_node.h"

#include <optional>

#include "core/markup.h"
#include "core/program.h"
#include "e2e_cdiff/core/exceptions.h"
#include "node_graph/messages/map_markers.h"
#include "node_graph/messages/plan_markers.h"
#include "node_graph/messages/session_conversions.h"
#include "node_graph/messages/topics.h"
#include "node_graph/messages/traffic_conversions.h"
#include "node_graph/session_graph.h"

namespace cdiff::node_graph {
namespace {

constexpr std::uint32_t kSceneQueueSize = 100;

}  // namespace

int SceneNode::run() {
  using visualization_msgs::MarkerArray;
  const auto name = [](ChannelId id) { return Topic(id).name(); };
  markers_output_ = node_.advertise<MarkerArray>(name(ChannelId::kMarkers), kSceneQueueSize);
  map_output_ = node_.advertise<MarkerArray>(name(ChannelId::kMapMarkers), 1, true);
  rollouts_output_ =
      node_.advertise<MarkerArray>(name(ChannelId::kRolloutMarkers), kSceneQueueSize);
  view_output_ = node_.advertise<sensor_msgs::Image>(name(ChannelId::kFrontView), kSceneQueueSize);
  const auto at_once = ros::TransportHints().tcpNoDelay();
  const ros::Subscriber inputs[] = {
      node_.subscribe<msgs::SessionInfo>(
          name(ChannelId::kSession), 1,
          [this](const msgs::SessionInfo::ConstPtr& info) { takeSession(*info); }, {}, at_once),
      node_.subscribe<msgs::CbvSelection>(
          name(ChannelId::kSelection), kSceneQueueSize,
          [this](const msgs::CbvSelection::ConstPtr& selection) { takeSelection(selection); }, {},
          at_once),
      node_.subscribe<msgs::TrafficSnapshot>(
          name(ChannelId::kTraffic), kSceneQueueSize,
          [this](const msgs::TrafficSnapshot::ConstPtr& snapshot) { takeTraffic(*snapshot); }, {},
          at_once)};
  while (!stop_.raised() && ros::ok()) spin(kSpinPeriod);
  return core::ExitCode::kPassed;
}

void SceneNode::takeSession(const msgs::SessionInfo& info) {
  try {
    setup_ = setupOf(info);
  } catch (const core::InputError& error) {
    ROS_ERROR("the session cannot be shown: %s", core::plainText(error.what()).c_str());
    return;
  }
  markers_ = std::make_unique<SessionMarkers>(*setup_);
  front_view_ = std::make_unique<FrontView>(*setup_);
  plans_.clear();
  selection_.reset();
  map_output_.publish(mapMarkers(*setup_));
  listenToRollouts();
}

void SceneNode::listenToRollouts() {
  rollouts_.clear();
  for (int slot = 0; slot < setup_->options().max_cbv; ++slot) {
    rollouts_.push_back(node_.subscribe<msgs::Rollout>(
        Topic(ChannelId::kCbvRollout, slot).name(), kSceneQueueSize,
        [this](const msgs::Rollout::ConstPtr& rollout) { takeRollout(*rollout); }, {},
        ros::TransportHints().tcpNoDelay()));
  }
}

void SceneNode::takeSelection(const msgs::CbvSelection::ConstPtr& selection) {
  selection_ = selection;
}

/// As the bag has it, the selection of a tick comes after its snapshot: routes and conflict points
/// are those of the decision before.
void SceneNode::takeTraffic(const msgs::TrafficSnapshot& message) {
  const bool final = message.status != msgs::TrafficSnapshot::RUNNING;
  if (!setup_) return;
  try {
    last_ = fromMsg(message);
    markers_->note(last_);
    if (message.decision_tick || final) show();
  } catch (const core::InputError& error) {
    ROS_ERROR_THROTTLE(1.0, "a tick cannot be shown: %s", core::plainText(error.what()).c_str());
  }
}

void SceneNode::show() {
  std::optional<cbv::CbvSelection> selection;
  if (selection_) selection = fromMsg(*selection_, setup_->network());
  std::vector<planning::PlannedAction> plans;
  for (const auto& [slot, plan] : plans_) plans.push_back(plan);
  session::TickRecord record;
  record.snapshot = &last_;
  record.selection = selection ? &*selection : nullptr;
  record.actions = &plans;
  markers_output_.publish(markers_->build(record));
  if (view_output_.getNumSubscribers() == 0) return;
  view_output_.publish(front_view_->draw(last_, &plans));
}

void SceneNode::takeRollout(const msgs::Rollout& message) {
  planning::PlannedAction action;
  action.slot = message.slot;
  action.vehicle_id = message.vehicle_id;
  action.rollout = fromMsg(message);
  action.candidates = candidatesFromMsg(message);
  rollouts_output_.publish(planMarkers({action}, last_));
  plans_[message.slot] = action;
}

}  // namespace cdiff::node_graph
