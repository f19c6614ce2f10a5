// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/nodes/replay_node.h"

#include <algorithm>
#include <system_error>

#include "core/markup.h"
#include "core/program.h"
#include "core/text.h"
#include "e2e_cdiff/DeleteEntity.h"
#include "e2e_cdiff/ResetSimulation.h"
#include "e2e_cdiff/SetEntityState.h"
#include "e2e_cdiff/SetSimulationState.h"
#include "e2e_cdiff/SpawnEntity.h"
#include "e2e_cdiff/SteerSession.h"
#include "e2e_cdiff/StepSimulation.h"
#include "e2e_cdiff/core/exceptions.h"
#include "node_graph/bags/replay.h"
#include "node_graph/lockstep/decision_tracker.h"
#include "node_graph/lockstep/node_process.h"
#include "node_graph/lockstep/tick_record.h"
#include "node_graph/messages/plan_markers.h"
#include "node_graph/messages/session_conversions.h"
#include "node_graph/messages/traffic_conversions.h"
#include "node_graph/session_files.h"
#include "node_graph/session_graph.h"
#include "rosgraph_msgs/Clock.h"

namespace cdiff::node_graph {
namespace {

namespace fs = std::filesystem;

constexpr double kPatience = 30.0;  // [s] of wall time for the metrics node to do its next thing
constexpr double kReplayFarewell = 5.0;     // [s] for its files when the replay is interrupted
constexpr double kHeartbeatTimeout = 10.0;  // [s] until the metrics node takes us for lost
constexpr double kStraggle = 0.1;           // [s] for the answers to a tick that lacks some

/// Rate from the parameter: a number from 0.
double rateOf(const Parameters& parameters) {
  const std::string text = parameters.text("rate");
  if (text.empty()) return 1.0;
  const auto rate = core::parseNumber(text);
  if (!rate || *rate < 0.0)
    throw core::InputError("parameter ~rate is '" + text +
                           "'; expected times real time, or 0 for as fast as possible");
  return *rate;
}

fs::path bagOf(const Parameters& parameters) {
  parameters.requireKnown({"bag", "results", "rate", "folder", "overwrite"});
  if (parameters.text("bag").empty())
    throw core::InputError("parameter ~bag is missing: the bag to replay (bag:=FILE)");
  const fs::path folder = parameters.text("folder");
  return (folder / parameters.text("bag")).lexically_normal();
}

/// The folder given, else one of its own.
fs::path folderOf(const Parameters& parameters, const session::ScenarioOptions& options) {
  const std::string given = parameters.text("results");
  return resultFolder(given.empty() ? "" : fs::path(parameters.text("folder")) / given, options);
}

/// A service of a session that would change it, whatever it is asked.
template <class Service>
ros::ServiceServer refusing(ros::NodeHandle& node, const std::string& name) {
  const boost::function<bool(typename Service::Request&, typename Service::Response&)> refuse =
      [](typename Service::Request&, typename Service::Response& response) {
        response.result.result = msgs::Result::RESULT_FEATURE_UNSUPPORTED;
        response.result.error_message =
            "this is the replay of a bag: what was recorded does not change; steer a session "
            "(session.launch), or repeat this one with other steering (steering:=FILE)";
        return true;
      };
  return node.advertiseService(name, refuse);
}

std::vector<ros::ServiceServer> refusals(ros::NodeHandle& node) {
  return {refusing<msgs::SetSimulationState>(node, "set_simulation_state"),
          refusing<msgs::StepSimulation>(node, "step_simulation"),
          refusing<msgs::ResetSimulation>(node, "reset_simulation"),
          refusing<msgs::SpawnEntity>(node, "spawn_entity"),
          refusing<msgs::DeleteEntity>(node, "delete_entity"),
          refusing<msgs::SetEntityState>(node, "set_entity_state"),
          refusing<msgs::SteerSession>(node, "steer")};
}

/// Who takes part in a replay: the metrics node works, and listens to what the others said.
SessionGraph replayGraph(SessionGraph graph) {
  auto& nodes = graph.participants;
  nodes.erase(std::remove(nodes.begin(), nodes.end(), kRecorderNode), nodes.end());
  if (!graph.has(kMetricsNode)) nodes.emplace_back(kMetricsNode);
  return graph;
}

}  // namespace

ReplayNode::ReplayNode(const Parameters& parameters, StopSignal& stop)
    : stop_(stop),
      rate_(rateOf(parameters)),
      bag_(bagOf(parameters)),
      session_(bag_),
      graph_(replayGraph(session_.graph())),
      participants_(std::vector<std::string>{kMetricsNode}),
      heartbeat_(node_, kHeartbeatTimeout),
      display_(node_) {
  results_ = folderOf(parameters, session_.setup().options());
  const bool overwrite = parameters.flag("overwrite", false);
  requireReplayFolder(bag_, results_, overwrite);
  folder_ = std::make_unique<record::ResultFolder>(results_, kReplayLaunch, overwrite);
  display_.showSensors(session_.setup());
  if (graph_.has(kCameraNode)) display_.showCameras(session_.setup().rigs());
}

/// A replay waits for the metrics node alone; others may listen.
void ReplayNode::offer(const Topic& topic) {
  const std::vector<std::string> nodes = listeners(topic, graph_);
  const bool counted = std::find(nodes.begin(), nodes.end(), kMetricsNode) != nodes.end();
  const std::vector<std::string> expected =
      counted ? std::vector<std::string>{kMetricsNode} : std::vector<std::string>();
  const Channel& row = topic.row();
  topics_[topic] = row.type.advertise(connections_, node_, topic.name(), expected, row.latched);
}

void ReplayNode::advertise() {
  for (const ChannelId id : {ChannelId::kClock, ChannelId::kSession, ChannelId::kTraffic,
                             ChannelId::kEgoRoute, ChannelId::kRolloutMarkers})
    offer(id);
  for (const Channel& row : channels()) {
    if (!replayed(row, graph_)) continue;
    for (const Topic& topic : topicsOf(row, graph_)) offer(topic);
  }
  gate_.setReport([](const std::string& text) { ROS_WARN("%s", core::plainText(text).c_str()); });
  acks_ = gate_.subscribe<msgs::TickAck>(node_, Topic(ChannelId::kTickAck).name(),
                                         {siblingNode(kMetricsNode)},
                                         [this](const auto& ack) { participants_.note(*ack); });
  refusals_ = refusals(node_);
}

void ReplayNode::publishSession() {
  msgs::SessionInfo info = session_.info();
  info.deployment = replayDeployment(kReplayLaunch, info);
  info.results_folder = results_.string();
  putGraph(graph_, info);
  topics_.at(ChannelId::kSession).publish(shared(info));
  topics_.at(ChannelId::kEgoRoute).publish(toPathMsg(session_.setup().egoRoute()));
}

void ReplayNode::publishTick(const msgs::TrafficSnapshot::ConstPtr& snapshot) {
  rosgraph_msgs::Clock clock;
  clock.clock = snapshot->header.stamp;
  topics_.at(ChannelId::kClock).publish(clock);
  topics_.at(ChannelId::kTraffic).publish(snapshot);
  if (snapshot->decision_tick) publishAnswers(*snapshot);
  display_.publish(fromMsg(*snapshot));
}

void ReplayNode::publishAnswers(const msgs::TrafficSnapshot& snapshot) {
  TickMessages messages = session_.answers().messages(snapshot.tick);
  if (graph_.recordsDecisions())  // earlier versions recorded none
    messages.add(ChannelId::kDecisionRecord, shared(punctualRecord(snapshot, session_.answers())));
  const session::ScenarioOptions& options = session_.setup().options();
  const TickReading reading{session_.setup().rigs(), options.simulation_step};
  for (const auto& [topic, publisher] : topics_) {
    const Channel& row = topic.row();
    if (!replayed(row, graph_)) continue;
    AnyMessage message = messages.find(topic);
    if (!message && row.derive != nullptr) message = row.derive(messages, reading, topic);
    if (message) row.type.publish(publisher, message);
  }
  if (topics_.at(ChannelId::kRolloutMarkers).getNumSubscribers() > 0) publishPlans(snapshot);
}

/// The plans of CBVs for rviz, which live their planner's node shows.
void ReplayNode::publishPlans(const msgs::TrafficSnapshot& snapshot) {
  std::vector<planning::PlannedAction> actions = actionsOf(session_.answers().answers(snapshot));
  const auto of_ego = [](const planning::PlannedAction& action) { return action.slot == kEgoSlot; };
  actions.erase(std::remove_if(actions.begin(), actions.end(), of_ego), actions.end());
  topics_.at(ChannelId::kRolloutMarkers).publish(planMarkers(actions, fromMsg(snapshot)));
}

bool ReplayNode::disturbed() {
  if (participants_.error())
    ROS_ERROR("%s: %s", participants_.error()->node.c_str(),
              core::plainText(participants_.error()->text).c_str());
  if (connections_.hasLeft(kMetricsNode)) ROS_ERROR("the metrics node left the replay");
  failed_ = participants_.error() || connections_.hasLeft(kMetricsNode);
  return failed_ || stop_.raised() || !ros::ok();
}

bool ReplayNode::waitFor(const std::function<std::vector<std::string>()>& missing) {
  const Clock::time_point begin = Clock::now();
  while (!disturbed()) {
    const std::vector<std::string> texts = missing();
    if (texts.empty()) return true;
    if (secondsSince(begin) > kPatience) {
      ROS_ERROR("nothing came for %g s: %s", kPatience, core::joinText(texts, "; ").c_str());
      failed_ = true;
      return false;
    }
    spin(kSpinPeriod);
  }
  return false;
}

void ReplayNode::waitUntilDue(double time) {
  while (rate_ > 0.0 && !disturbed()) {
    const double left = time / rate_ - secondsSince(begin_);
    if (left <= 0.0) return;
    spin(std::min(left, kSpinPeriod));
  }
}

std::vector<std::string> ReplayNode::notReady() const {
  std::vector<std::string> texts = connections_.missing();
  for (const std::string& text : participants_.notReady()) texts.push_back(text);
  return texts;
}

int ReplayNode::run() {
  advertise();
  publishSession();
  if (waitFor([this] { return notReady(); })) replayTicks();
  if (!failed_ && stop_.raised()) publishInterruption();
  return finish();
}

void ReplayNode::replayTicks() {
  begin_ = Clock::now();
  bool going = true;
  while (going) {
    const auto snapshot = session_.next();
    if (!snapshot) return;
    waitUntilDue(snapshot->time);
    publishTick(snapshot);
    last_ = snapshot;
    going = waitForMetrics(*snapshot);
  }
}

/// A tick that lacks answers is acknowledged when the next one has arrived.
bool ReplayNode::waitForMetrics(const msgs::TrafficSnapshot& snapshot) {
  const bool last = snapshot.status != msgs::TrafficSnapshot::RUNNING;
  if (!last && !session_.answers().missing(snapshot).empty()) {
    const Clock::time_point begin = Clock::now();
    while (!disturbed() && secondsSince(begin) < kStraggle) spin(kStraggle);
    return !disturbed();
  }
  return waitFor([&] {
    return last ? participants_.notFinished() : participants_.notAcknowledged(snapshot.tick);
  });
}

/// A last snapshot, so that the metrics node writes the result of the ticks replayed so far.
void ReplayNode::publishInterruption() {
  if (!last_ || last_->status != msgs::TrafficSnapshot::RUNNING || !ros::ok()) return;
  const traffic::TrafficSnapshot end =
      endedAfter(fromMsg(*last_), session_.setup().options().simulation_step,
                 traffic::SessionStatus::kInterrupted, {0, "user", "the replay was interrupted"});
  publishTick(boost::make_shared<const msgs::TrafficSnapshot>(toMsg(end)));
  const Clock::time_point begin = Clock::now();
  while (!participants_.notFinished().empty() && ros::ok() && secondsSince(begin) < kReplayFarewell)
    spin(kSpinPeriod);
}

int ReplayNode::finish() {
  for (const std::string& finding : session_.findings())
    ROS_WARN("bag '%s': %s", bag_.c_str(), core::plainText(finding).c_str());
  if (!failed_ && (stop_.raised() || !ros::ok())) return core::ExitCode::kInterrupted;
  if (!failed_ && session_.findings().empty()) {
    endLaunch(stop_);
    return core::ExitCode::kPassed;
  }
  writeExitCode(results_, core::ExitCode::kRunTimeError);
  return core::ExitCode::kRunTimeError;
}

int runReplay(StopSignal& stop) {
  const Parameters parameters = Parameters::ofThisNode();
  try {
    requireHeededLaunchArguments();
    return ReplayNode(parameters, stop).run();
  } catch (const core::InputError&) {
    const std::string given = parameters.text("results");
    writeRefusal(given.empty() ? fs::path() : fs::path(parameters.text("folder")) / given);
    throw;
  }
}

}  // namespace cdiff::node_graph
