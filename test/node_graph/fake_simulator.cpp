// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/fake_simulator.h"

#include <algorithm>

#include "node_graph/session_graph.h"
#include "planners/diffusion/diffusion_options.h"
#include "support/random_model.h"

namespace cdiff::test {

using namespace node_graph;  // NOLINT: a test of that layer

namespace {

template <class Message, class Callback>
ros::Subscriber subscribe(ros::NodeHandle& node_handle, const Topic& topic, Callback callback) {
  return node_handle.subscribe<Message>(
      topic.name(), 1000, boost::function<void(const boost::shared_ptr<const Message>&)>(callback),
      {}, ros::TransportHints().tcpNoDelay());
}

session::ScenarioOptions scenarioFor(const std::string& node,
                                     const std::filesystem::path& results) {
  session::ScenarioOptions options = session::loadScenario("crossing_left_turn");
  options.cbv_planner = node == kDiffusionPlannerNode ? "diffusion" : "pdm_lite";
  if (node != kDiffusionPlannerNode) return options;
  options.planner_options.of<planners::DiffusionOptions>().model =
      testing::writeRandomModel(results / "model");
  return options;
}

}  // namespace

FakeSimulator::FakeSimulator(const std::string& node, const std::filesystem::path& results)
    : setup_(scenarioFor(node, results)), graph_(graphOf(setup_.options(), {false, true}, {node})) {
  listen();
  answerForOthers(node);
  publishSession(results);
}

void FakeSimulator::publishSession(const std::filesystem::path& results) {
  session_ = connections_.advertise<msgs::SessionInfo>(
      node_, Topic(ChannelId::kSession).name(), listeners(ChannelId::kSession, graph_), true);
  route_ = connections_.advertise<nav_msgs::Path>(node_, Topic(ChannelId::kEgoRoute).name(),
                                                  listeners(ChannelId::kEgoRoute, graph_), true);
  traffic_ = connections_.advertise<msgs::TrafficSnapshot>(node_, Topic(ChannelId::kTraffic).name(),
                                                           listeners(ChannelId::kTraffic, graph_));
  msgs::SessionInfo info = toMsg(setup_);
  putGraph(graph_, info);
  info.results_folder = results.string();
  info.deployment = "test";
  info.simulator_version = "none";
  session_.publish(info);
  route_.publish(toPathMsg(setup_.egoRoute()));
}

void FakeSimulator::answerForOthers(const std::string& node) {
  const auto offer = [this](const Topic& topic) {
    others_[topic] = topic.row().type.advertise(connections_, node_, topic.name(),
                                                listeners(topic, graph_), false);
  };
  if (node != kCbvIdentificationNode) offer(ChannelId::kSelection);
  if (node != kEgoPlannerNode) offer(ChannelId::kEgoControl);
  if (node == kDiffusionPlannerNode) {
    for (int slot = 0; slot < graph_.max_cbv; ++slot) offer(imageOf(slot));
  }
  if (node == kCbvPlannerNode || node == kDiffusionPlannerNode) return;
  for (int slot = 0; slot < graph_.max_cbv; ++slot) {
    offer(controlOf(slot));
    offer(Topic(ChannelId::kCbvRollout, slot));
  }
}

void FakeSimulator::listen() {
  inputs_ = {subscribe<msgs::TickAck>(node_, ChannelId::kTickAck,
                                      [this](const auto& ack) { acks_.push_back(*ack); }),
             subscribe<msgs::CbvSelection>(node_, ChannelId::kSelection,
                                           [this](const auto& m) { selections[m->tick] = m; }),
             subscribe<msgs::ControlAction>(node_, ChannelId::kEgoControl,
                                            [this](const auto& m) { ego_controls[m->tick] = m; }),
             subscribe<msgs::ControlAction>(node_, controlOf(0),
                                            [this](const auto& m) { cbv_controls[m->tick] = m; }),
             subscribe<msgs::ControlAction>(node_, controlOf(1), [](const auto&) {}),
             subscribe<msgs::GuidanceReport>(node_, ChannelId::kGuidance,
                                             [this](const auto& m) { guidance[m->tick] = m; }),
             subscribe<sensor_msgs::Image>(
                 node_, imageOf(0),
                 [this](const auto& m) { images[nearestTick(m->header.stamp, 0.05)] = m; }),
             subscribe<sensor_msgs::Image>(
                 node_, imageOf(kEgoSlot),
                 [this](const auto& m) { ego_images[nearestTick(m->header.stamp, 0.05)] = m; }),
             subscribe<sensor_msgs::CameraInfo>(
                 node_, cameraInfoOf(0),
                 [this](const auto& m) { infos[nearestTick(m->header.stamp, 0.05)] = m; }),
             subscribe<msgs::Rollout>(node_, Topic(ChannelId::kCbvRollout, 0),
                                      [this](const auto& m) { rollouts[m->tick] = m; }),
             subscribe<msgs::MetricReport>(node_, ChannelId::kMetrics,
                                           [this](const auto& m) { reports[m->tick] = m; })};
}

bool FakeSimulator::ready() {
  return until([this] {
    const bool reported = !graph_.has(kMetricsNode) || inputs_.back().getNumPublishers() > 0;
    const bool shown =
        !graph_.has(kCameraNode) || std::all_of(inputs_.end() - 5, inputs_.end() - 2,
                                                [](auto& in) { return in.getNumPublishers() > 0; });
    return reported && shown && connections_.missing().empty() &&
           acknowledged(msgs::TickAck::READY, 0);
  });
}

bool FakeSimulator::acknowledged(std::uint8_t kind, std::uint64_t tick) const {
  return std::any_of(acks_.begin(), acks_.end(), [&](const msgs::TickAck& ack) {
    return ack.kind == kind && ack.tick == tick;
  });
}

traffic::TrafficSnapshot FakeSimulator::snapshot(std::uint64_t tick) const {
  const geometry::Polyline& path = setup_.egoRoute().path();
  traffic::TrafficSnapshot snapshot;
  snapshot.tick = tick;
  snapshot.time = static_cast<double>(tick) * setup_.options().simulation_step;
  snapshot.decision_tick = tick % setup_.ticksPerDecision() == 0;
  for (const double arc_length : {0.0, 30.0}) {
    const bool ego = arc_length == 0.0;
    traffic::Vehicle vehicle;
    vehicle.id = ego ? "ego" : "bg_0";
    vehicle.role = ego ? traffic::VehicleRole::kEgo : traffic::VehicleRole::kBackground;
    vehicle.state = {path.positionAt(arc_length), path.pointAt(arc_length).z(),
                     path.headingAt(arc_length), 5.0};
    snapshot.vehicles.push_back(vehicle);
  }
  return snapshot;
}

cbv::CbvSelection FakeSimulator::selection(std::uint64_t tick) const {
  cbv::CbvSelection selection;
  selection.tick = tick;
  selection.assignments.resize(1);
  selection.assignments[0].vehicle_id = "bg_0";
  selection.assignments[0].conflict_aware_route = setup_.egoRoute();
  return selection;
}

void FakeSimulator::publishSelection(const traffic::TrafficSnapshot& snapshot) {
  others_.at(ChannelId::kSelection)
      .publish(toMsg(selection(snapshot.tick), snapshot.time, setup_.network()));
}

void FakeSimulator::publishImage(const sensor_msgs::Image& image) {
  others_.at(imageOf(0)).publish(image);
}

void FakeSimulator::answer(const traffic::TrafficSnapshot& snapshot) {
  const planning::PlannedAction cbv{0, "bg_0", {0.2, 0.0, 0.0}, {}};
  others_.at(controlOf(0)).publish(toMsg(cbv, snapshot, {"cbv:test", 2.0, {}}));
  others_.at({ChannelId::kCbvRollout, 0}).publish(toRolloutMsg(cbv, snapshot));
  others_.at(ChannelId::kEgoControl)
      .publish(toMsg(planning::PlannedAction{-1, "ego", {0.3, 0.0, 0.0}, {}}, snapshot,
                     {"ego:test", 1.0, {}}));
  publishSelection(snapshot);
}

}  // namespace cdiff::test
