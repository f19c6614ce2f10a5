// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/traffic_simulator_ros.h"

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "ros/conversions.h"
#include "ros/launched_nodes.h"
#include "ros/message_checks.h"
#include "ros/session_files.h"
#include "ros/session_parts.h"
#include "ros/spinning.h"
#include "rosgraph_msgs/Clock.h"

namespace cdiff::ros {
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

TrafficSimulatorRos::TrafficSimulatorRos(const Parameters& parameters, StopSignal& stop)
    : stop_(stop),
      heartbeat_(node_, parameters.positive("heartbeat_timeout", 10.0)),
      book_({}),
      paced_answers_(0.05),
      decisions_({}),
      display_(node_) {
  parameters.requireKnown(knownParameters());
  limits_ = {parameters.positive("start_timeout", 30.0),
             parameters.positive("answer_timeout", 30.0)};
  enterFolder(parameters.text("folder"));
  const session::ScenarioOptions options = session::resolveRequest(sessionRequest(parameters));
  results_ = resultFolder(parameters.text("results"), options);
  const bool overwrite = parameters.flag("overwrite", false);
  record::requireFreeFolder(results_, overwrite);
  setup_ = std::make_unique<session::SessionSetup>(options);
  folder_ = std::make_unique<record::ResultFolder>(results_, kDeployment, overwrite);
  const GraphRequest request{parameters.flag("record", false), parameters.flag("camera", false)};
  graph_ = graphOf(options, request, core::splitText(parameters.text("participants"), ' '));
  if (graph_.has(kCameraNode)) display_.showCameras(setup_->options().camera);
  book_ = ParticipantBook(graph_.participants);
  answers_ = TickAnswers(options.simulation_step);
  paced_answers_ = PacedAnswers(options.simulation_step, setup_->ticksPerDecision());
  decisions_ = DecisionBook(options);
}

int TrafficSimulatorRos::run() {
  begin_ = Clock::now();
  if (!startWorld()) return 2;
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

bool TrafficSimulatorRos::startWorld() {
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

void TrafficSimulatorRos::advertise() {
  clock_ = connections_.advertise<rosgraph_msgs::Clock>(node_, "/clock", {});
  session_ = connections_.advertise<msgs::SessionInfo>(node_, kSessionTopic,
                                                       listeners(kSessionTopic, graph_), true);
  traffic_ = connections_.advertise<msgs::TrafficSnapshot>(node_, kTrafficTopic,
                                                           listeners(kTrafficTopic, graph_), true);
  route_ = connections_.advertise<nav_msgs::Path>(node_, kEgoRouteTopic,
                                                  listeners(kEgoRouteTopic, graph_), true);
  if (!graph_.recordsDecisions()) return;
  records_ = connections_.advertise<msgs::DecisionRecord>(node_, kDecisionRecordTopic,
                                                          listeners(kDecisionRecordTopic, graph_));
}

void TrafficSimulatorRos::listen() {
  gate_.setReport([this](const std::string& text) { noteFault(kTrafficSimulatorNode, text); });
  gate_.setNewestTick(0, setup_->options().simulation_step);
  listenTo<msgs::TickAck>(kTickAckTopic, [this](const auto& ack) {
    if (ack->kind == msgs::TickAck::FAULT)
      noteFault(ack->node, ack->text);
    else
      book_.note(*ack);
  });
  listenTo<msgs::CbvSelection>(kSelectionTopic, [this](const auto& message) {
    std::string wrong = unusable(*message, graph_.max_cbv);
    if (wrong.empty()) wrong = unusable(*message, setup_->network());
    if (!wrong.empty()) return wrong;
    answers_.add(message);
    noteArrival(DecisionBook::kSelection, message->tick);
    return wrong;
  });
  listenTo<msgs::ControlAction>(kEgoControlTopic, [this](const auto& message) {
    ego_heard_at_ = Clock::now();
    noteArrival(kEgoSlot, answers_.addEgo(message, paced() ? world_->snapshot().tick : 0));
  });
  ego_control_ = inputs_.back();
  for (int slot = 0; slot < graph_.max_cbv; ++slot) listenToSlot(slot);
}

void TrafficSimulatorRos::listenToSlot(int slot) {
  listenTo<msgs::ControlAction>(cbvControlTopic(slot), [this, slot](const auto& message) {
    if (message->slot != slot) return wrongSlot(message->slot);
    answers_.addCbv(slot, message);
    noteArrival(slot, message->tick);
    return std::string();
  });
  if (!paced()) return;
  listenTo<msgs::Rollout>(cbvRolloutTopic(slot), [this, slot](const auto& message) {
    if (message->slot != slot) return wrongSlot(message->slot);
    answers_.addRollout(slot, message);
    return std::string();
  });
}

void TrafficSimulatorRos::noteArrival(int slot, std::uint64_t tick) {
  if (paced()) decisions_.arrived(slot, tick, secondsSince(begin_));
}

/// A fault that a node reports is recorded once, whoever else reports it too.
void TrafficSimulatorRos::noteFault(const std::string& source, const std::string& text) {
  constexpr std::size_t kMostFaults = 200;
  if (noted_faults_.size() == kMostFaults || !noted_faults_.insert(text).second) return;
  ROS_WARN("%s: %s", source.c_str(), text.c_str());
  world_->recordFault(source, text);
}

void TrafficSimulatorRos::publishSession() {
  msgs::SessionInfo info = toMsg(*setup_);
  info.simulator_version = world_->simulatorVersion();
  info.package_version = E2E_CDIFF_VERSION;
  info.deployment = kDeployment;
  info.results_folder = results_.string();
  putGraph(graph_, info);
  session_.publish(boost::make_shared<const msgs::SessionInfo>(info));
  route_.publish(boost::make_shared<const nav_msgs::Path>(toPathMsg(setup_->egoRoute())));
}

std::vector<TrafficSimulatorRos::Missing> TrafficSimulatorRos::missingParticipants() const {
  std::vector<Missing> missing;
  if (graph_.external_ego && ego_control_.getNumPublishers() == 0) {
    missing.push_back({"the external ego planner",
                       "no node publishes ego/control yet; start yours (external_ego_node is an "
                       "example)"});
  }
  for (const std::string& text : book_.notReady())
    missing.push_back({text.substr(0, text.find(' ')), text});
  for (const std::string& text : connections_.missing())
    missing.push_back({text.substr(0, text.find(' ')), text});
  return missing;
}

std::optional<TrafficSimulatorRos::Ending> TrafficSimulatorRos::waitForParticipants() {
  return waitFor([this] { return missingParticipants(); }, limits_.start);
}

TrafficSimulatorRos::Ending TrafficSimulatorRos::ending(SessionStatus status,
                                                        const std::string& source,
                                                        const std::string& text) const {
  return {status, {world_->snapshot().tick, source, text}};
}

void TrafficSimulatorRos::endSession(const Ending& ending) {
  ROS_ERROR_COND(ending.status == SessionStatus::kError, "%s: %s", ending.fault.source.c_str(),
                 ending.fault.text.c_str());
  world_->end(ending.status, ending.fault);
}

std::unique_ptr<ReserveResult> TrafficSimulatorRos::makeReserve(const std::string& version) const {
  return std::make_unique<ReserveResult>(*setup_, record::RunFacts{kDeployment, version, !paced()},
                                         results_);
}

int runTrafficSimulator(StopSignal& stop) {
  const Parameters parameters = Parameters::ofThisNode();
  try {
    requireKnownLaunchArguments();
    return TrafficSimulatorRos(parameters, stop).run();
  } catch (const core::InputError&) {
    writeRefusal(parameters.text("results"));
    noteRefusal();
    throw;
  }
}

int TrafficSimulatorRos::exitCode() const {
  if (world_->snapshot().status == SessionStatus::kError) return 2;
  return world_->snapshot().status == SessionStatus::kInterrupted ? 130 : 0;
}

}  // namespace cdiff::ros
