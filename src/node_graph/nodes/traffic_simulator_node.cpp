// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/nodes/traffic_simulator_node.h"

#include "core/program.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "node_graph/lockstep/node_process.h"
#include "node_graph/lockstep/participant.h"
#include "node_graph/messages/message_checks.h"
#include "node_graph/messages/session_conversions.h"
#include "node_graph/messages/traffic_conversions.h"
#include "node_graph/session_files.h"
#include "node_graph/session_graph.h"

namespace cdiff::node_graph {
namespace {

namespace fs = std::filesystem;
using traffic::SessionStatus;

std::vector<std::string> knownParameters() {
  return {"scenario",         "bench2drive",    "route",   "network", "mode",   "ego_planner",
          "cbv_planner",      "seed",           "set",     "record",  "folder", "participants",
          "start_timeout",    "answer_timeout", "results", "camera",  "video",  "overwrite",
          "heartbeat_timeout"};
}

}  // namespace

TrafficSimulatorNode::TrafficSimulatorNode(const Parameters& parameters, StopSignal& stop)
    : stop_(stop),
      heartbeat_(node_, parameters.positive("heartbeat_timeout", 10.0)),
      book_({}),
      paced_answers_(0.05),
      display_(node_) {
  parameters.requireKnown(knownParameters());
  limits_ = {parameters.positive("start_timeout", 30.0),
             parameters.positive("answer_timeout", 30.0)};
  enterFolder(parameters.text("folder"));
  const session::ScenarioOptions options = requestedScenario(parameters);
  results_ = resultFolder(parameters.text("results"), options);
  const bool overwrite = parameters.flag("overwrite", false);
  record::requireFreeFolder(results_, overwrite);
  setup_ = std::make_unique<session::SessionSetup>(options);
  folder_ = std::make_unique<record::ResultFolder>(results_, kDeployment, overwrite);
  const GraphRequest request{parameters.flag("record", false), parameters.flag("camera", false)};
  graph_ = graphOf(options, request, core::splitText(parameters.text("participants"), ' '));
  if (graph_.has(kCameraNode)) display_.showCameras(setup_->rigs());
  book_ = ParticipantTracker(graph_.participants);
  answers_ = TickAnswers(options.simulation_step);
  paced_answers_ = PacedAnswers(options.simulation_step, setup_->ticksPerDecision());
  decisions_.emplace(options);
}

int TrafficSimulatorNode::run() {
  begin_ = Clock::now();
  if (!startWorld()) return core::ExitCode::kRunTimeError;
  advertise();
  listen();
  publishSession();
  if (const auto ending = waitForParticipants()) endSession(*ending);
  begin_ = Clock::now();
  runTicks();
  waitForObservers();
  reserve_.reset();
  return exitCode();
}

bool TrafficSimulatorNode::startWorld() {
  try {
    world_ = std::make_unique<session::World>(*setup_);
    reserve_ = makeReserve(world_->simulatorVersion());
    return true;
  } catch (const core::SimulatorError& error) {
    ROS_ERROR("%s", error.what());
    traffic::TrafficSnapshot snapshot;
    snapshot.status = SessionStatus::kError;
    snapshot.faults.push_back({0, "simulator", error.what()});
    reserve_ = makeReserve("unknown");
    writeResultAlone(snapshot);
    return false;
  }
}

ros::Publisher TrafficSimulatorNode::advertise(const Topic& topic) {
  const Channel& row = topic.row();
  return row.type.advertise(connections_, node_, topic.name(), listeners(topic, graph_),
                            row.latched);
}

void TrafficSimulatorNode::advertise() {
  clock_ = advertise(ChannelId::kClock);
  session_ = advertise(ChannelId::kSession);
  traffic_ = advertise(ChannelId::kTraffic);
  route_ = advertise(ChannelId::kEgoRoute);
  if (graph_.recordsDecisions()) records_ = advertise(ChannelId::kDecisionRecord);
}

void TrafficSimulatorNode::listen() {
  gate_.setReport([this](const std::string& text) { noteFault(kTrafficSimulatorNode, text); });
  gate_.setNewestTick(0, setup_->options().simulation_step);
  inputs_.push_back(gate_.subscribe<msgs::TickAck>(
      node_, Topic(ChannelId::kTickAck).name(),
      siblingNodes(publishersOf(ChannelId::kTickAck, graph_)), [this](const auto& ack) {
        if (ack->kind == msgs::TickAck::FAULT)
          noteFault(ack->node, ack->text);
        else
          book_.note(*ack);
      }));
  for (const Channel& row : channels()) {
    if (row.use != Use::kAnswer || !listensTo(row, Party::kSimulator, graph_)) continue;
    for (const Topic& topic : topicsOf(row, graph_)) listenTo(topic);
  }
}

void TrafficSimulatorNode::listenTo(const Topic& topic) {
  inputs_.push_back(topic.row().type.subscribe(
      gate_, node_, topic.name(), siblingNodes(publishersOf(topic, graph_)),
      [this, topic](const AnyMessage& message) { return takeAnswer(topic, message); }));
  if (topic.id == ChannelId::kEgoControl) ego_control_ = inputs_.back();
}

/// Returns why a message cannot be used; empty when it can.
std::string TrafficSimulatorNode::takeAnswer(const Topic& topic, const AnyMessage& message) {
  std::string wrong = unusable(message, topic, graph_);
  if (wrong.empty() && topic.id == ChannelId::kSelection)
    wrong = unusable(*messageAs<msgs::CbvSelection>(message), setup_->network());
  if (!wrong.empty()) return wrong;
  if (waitsForRollout(topic, message)) return wrong;
  const bool ego = topic.id == ChannelId::kEgoControl;
  if (ego) ego_heard_at_ = Clock::now();
  const std::uint64_t tick =
      answers_.add(topic, message, ego && paced() ? world_->snapshot().tick : 0);
  if (topic.id == ChannelId::kSelection) noteArrival(DecisionTracker::kSelection, tick);
  if (ego || topic.id == ChannelId::kCbvControl) noteArrival(topic.slot, tick);
  const auto early = early_controls_.find(topic.slot);
  if (topic.id != ChannelId::kCbvRollout || early == early_controls_.end()) return wrong;
  const AnyMessage control = early->second;  // which the call below takes out of the map
  takeAnswer({ChannelId::kCbvControl, topic.slot}, control);
  return wrong;
}

/// Where answers may be late, a CBV's control counts with the rollout that is sent before it but on
/// another connection, so that the next action of a plan is always that of the plan. The newest
/// control of a slot is kept until then.
bool TrafficSimulatorNode::waitsForRollout(const Topic& topic, const AnyMessage& message) {
  if (!paced() || topic.id != ChannelId::kCbvControl) return false;
  early_controls_.erase(topic.slot);
  const bool waits =
      answers_.rollout(topic.slot, messageAs<msgs::ControlAction>(message)->tick) == nullptr;
  if (waits) early_controls_[topic.slot] = message;
  return waits;
}

void TrafficSimulatorNode::noteArrival(int slot, std::uint64_t tick) {
  if (paced()) decisions_->arrived(slot, tick, secondsSince(begin_));
}

/// A fault that a node reports is recorded once, whoever else reports it too.
void TrafficSimulatorNode::noteFault(const std::string& source, const std::string& text) {
  constexpr std::size_t kMostFaults = 200;
  if (noted_faults_.size() == kMostFaults || !noted_faults_.insert(text).second) return;
  ROS_WARN("%s: %s", source.c_str(), text.c_str());
  world_->recordFault(source, text);
}

void TrafficSimulatorNode::publishSession() {
  msgs::SessionInfo info = toMsg(*setup_);
  info.simulator_version = world_->simulatorVersion();
  info.package_version = E2E_CDIFF_VERSION;
  info.deployment = kDeployment;
  info.results_folder = results_.string();
  putGraph(graph_, info);
  session_.publish(shared(info));
  route_.publish(shared(toPathMsg(setup_->egoRoute())));
}

std::vector<TrafficSimulatorNode::Missing> TrafficSimulatorNode::missingParticipants() const {
  std::vector<Missing> missing;
  if (graph_.external_ego && ego_control_.getNumPublishers() == 0) {
    missing.push_back(
        {"the external ego planner", "no node publishes " + Topic(ChannelId::kEgoControl).name() +
                                         " yet; start yours (external_ego_node is an example)"});
  }
  for (const std::string& text : book_.notReady())
    missing.push_back({text.substr(0, text.find(' ')), text});
  for (const std::string& text : connections_.missing())
    missing.push_back({text.substr(0, text.find(' ')), text});
  return missing;
}

std::optional<TrafficSimulatorNode::Ending> TrafficSimulatorNode::waitForParticipants() {
  return waitFor([this] { return missingParticipants(); }, limits_.start);
}

TrafficSimulatorNode::Ending TrafficSimulatorNode::ending(SessionStatus status,
                                                          const std::string& source,
                                                          const std::string& text) const {
  return {status, {world_->snapshot().tick, source, text}};
}

void TrafficSimulatorNode::endSession(const Ending& ending) {
  ROS_ERROR_COND(ending.status == SessionStatus::kError, "%s: %s", ending.fault.source.c_str(),
                 ending.fault.text.c_str());
  world_->end(ending.status, ending.fault);
}

std::unique_ptr<ReserveResult> TrafficSimulatorNode::makeReserve(const std::string& version) const {
  return std::make_unique<ReserveResult>(*setup_, record::RunFacts{kDeployment, version, !paced()},
                                         results_);
}

int runTrafficSimulator(StopSignal& stop) {
  const Parameters parameters = Parameters::ofThisNode();
  try {
    requireKnownLaunchArguments();
    return TrafficSimulatorNode(parameters, stop).run();
  } catch (const core::InputError&) {
    writeRefusal(parameters.text("results"));
    noteRefusal();
    throw;
  }
}

int TrafficSimulatorNode::exitCode() const {
  const SessionStatus status = world_->snapshot().status;
  if (status == SessionStatus::kError) return core::ExitCode::kRunTimeError;
  return status == SessionStatus::kInterrupted ? core::ExitCode::kInterrupted
                                               : core::ExitCode::kPassed;
}

}  // namespace cdiff::node_graph
