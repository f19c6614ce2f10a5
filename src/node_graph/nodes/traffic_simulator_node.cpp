// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/nodes/traffic_simulator_node.h"

#include <cstdlib>

#include "core/markup.h"
#include "core/program.h"
#include "core/stage_times.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "node_graph/lockstep/answer_waits.h"
#include "node_graph/lockstep/hosted_nodes.h"
#include "node_graph/lockstep/lockstep_pacer.h"
#include "node_graph/lockstep/wall_clock_pacer.h"
#include "node_graph/messages/message_checks.h"
#include "node_graph/messages/session_conversions.h"
#include "node_graph/messages/traffic_conversions.h"
#include "node_graph/node_main.h"
#include "node_graph/session_graph.h"
#include "rosgraph_msgs/Clock.h"
#include "traffic/shown_fault.h"

namespace cdiff::node_graph {
namespace {

using traffic::SessionStatus;

constexpr double kInterruptedPatience =
    10.0;  // [s] for the observers' files; roslaunch ends us 15 s after the user

std::vector<std::string> knownParameters() {
  return {"scenario",    "bench2drive", "route",        "network",       "mode",
          "ego_planner", "cbv_planner", "seed",         "steering",      "set",
          "record",      "folder",      "participants", "start_timeout", "answer_timeout",
          "results",     "camera",      "video",        "overwrite",     "heartbeat_timeout"};
}

/// In a namespace a session is one of several on a master, whose clocks would contradict.
bool ownsClock() { return ros::this_node::getNamespace() == "/"; }

const char* paceText(session::SessionControl::State state) {
  using State = session::SessionControl::State;
  if (state == State::kOver) return "over";
  if (state == State::kPlaying) return "playing";
  return state == State::kPaused ? "paused" : "stepping";
}

}  // namespace

TrafficSimulatorNode::TrafficSimulatorNode(const Parameters& parameters, StopSignal& stop)
    : stop_(stop),
      heartbeat_(node_, parameters.positive("heartbeat_timeout", 10.0)),
      participants_({}),
      watch_(stop_, participants_, connections_),
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
  if (graph_.external_ego) external_ego_ = std::make_unique<ExternalEgo>(*setup_, graph_);
  if (graph_.external_cbvs) {
    external_cbvs_ = std::make_unique<ExternalCbvs>(
        options.simulation_step, graph_.paced,
        [this](const Topic& topic, const AnyMessage& control) { pacer_->take(topic, control); });
  }
  display_.showSensors(*setup_);
  if (graph_.has(kCameraNode)) display_.showCameras(setup_->rigs());
  participants_ = ParticipantTracker(graph_.participants);
  pacer_ = makePacer();
}

std::unique_ptr<Pacer> TrafficSimulatorNode::makePacer() {
  PacerOutput output;
  output.fault = [this](const auto& source, const auto& text) {
    world_->recordFault(source, text);
  };
  output.record = [this](const auto& record) { records_.publish(record); };
  output.keep = [this](const auto& snapshot, const auto& answers) {
    reserve_->keep(snapshot, answers);
  };
  output.publish_again = [this](const auto& snapshot) { traffic_.publish(snapshot); };
  const PacedSession session{*setup_, graph_, participants_, watch_, limits_.answer};
  if (graph_.paced) return std::make_unique<WallClockPacer>(session, output);
  return std::make_unique<LockstepPacer>(session, output);
}

int TrafficSimulatorNode::run() {
  if (!startWorld()) return core::ExitCode::kRunTimeError;
  advertise();
  listen();
  services_ = std::make_unique<SessionServices>(world_->control(), *setup_);
  diagnostics_ =
      std::make_unique<diagnostic_updater::Updater>(node_, privateNodeHandle(), nodeName());
  diagnostics_->setHardwareID(setup_->options().name);
  diagnostics_->add("session", this, &TrafficSimulatorNode::diagnose);
  session_.publish(shared(sessionInfo(world_->simulatorVersion())));
  route_.publish(shared(toPathMsg(setup_->egoRoute())));
  if (const auto end = waitForParticipants()) endSession(*end);
  pacer_->begin();
  {
    const auto times = core::wantedStageTimes();
    runTicks();
    core::writeStageTimes(times.get());
  }
  writeWaits(pacer_->waits());
  waitForResult();
  reserve_.reset();
  folder_.reset();
  services_.reset();  // last: it waits for the ROS master, which may hang
  const int exit_code = exitCode();
  if (exit_code == core::ExitCode::kPassed) endLaunch(stop_);  // the others wait for our end
  return exit_code;
}

bool TrafficSimulatorNode::startWorld() {
  try {
    world_ = std::make_unique<session::World>(*setup_);
    reserve_ = std::make_unique<ResultReserve>(*setup_, sessionInfo(world_->simulatorVersion()));
    return true;
  } catch (const core::SimulatorError& error) {
    ROS_ERROR("%s", core::plainText(error.what()).c_str());
    traffic::TrafficSnapshot snapshot;
    snapshot.status = SessionStatus::kError;
    snapshot.faults.push_back({0, "simulator", error.what()});
    published_ = shared(toMsg(snapshot));
    reserve_ = std::make_unique<ResultReserve>(*setup_, sessionInfo("unknown"));
    writeResultAlone();
    return false;
  }
}

msgs::SessionInfo TrafficSimulatorNode::sessionInfo(const std::string& simulator_version) const {
  msgs::SessionInfo info = toMsg(*setup_);
  info.simulator_version = simulator_version;
  info.package_version = E2E_CDIFF_VERSION;
  info.deployment = kDeployment;
  info.results_folder = results_.string();
  putGraph(graph_, info);
  return info;
}

ros::Publisher TrafficSimulatorNode::advertise(const Topic& topic) {
  const Channel& row = topic.row();
  return row.type.advertise(connections_, node_, topic.name(), listeners(topic, graph_),
                            isLatched(row));
}

void TrafficSimulatorNode::advertise() {
  if (ownsClock()) clock_ = advertise(ChannelId::kClock);
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
          participants_.note(*ack);
      }));
  for (const Channel& row : channels()) {
    const bool external = external_ego_ && row.publisher == Party::kEgoPlanner;
    const bool answers = row.use == Use::kAnswer && listensTo(row, Party::kSimulator, graph_);
    if (external ? row.id != external_ego_->topic().id : !answers) continue;
    for (const Topic& topic : topicsOf(row, graph_)) listenTo(topic);
  }
}

void TrafficSimulatorNode::listenTo(const Topic& topic) {
  inputs_.push_back(topic.row().type.subscribe(
      gate_, node_, topic.name(), siblingNodes(publishersOf(topic, graph_)),
      [this, topic](const AnyMessage& message) { return takeAnswer(topic, message); }));
  if (ofUser(topic)) commands_[topic] = inputs_.back();
}

bool TrafficSimulatorNode::ofUser(const Topic& topic) const {
  if (external_ego_ && topic == external_ego_->topic()) return true;
  return external_cbvs_ && topic.id == ChannelId::kCbvControl;
}

/// Returns why a message cannot be used; empty when it can.
std::string TrafficSimulatorNode::takeAnswer(const Topic& topic, const AnyMessage& message) {
  if (ofUser(topic)) return takeCommand(topic, message);
  std::string wrong = unusable(message, topic, graph_);
  if (wrong.empty() && topic.id == ChannelId::kSelection)
    wrong = unusable(*messageAs<msgs::CbvSelection>(message), setup_->network());
  if (!wrong.empty()) return wrong;
  pacer_->take(topic, message);
  if (external_cbvs_ && topic.id == ChannelId::kSelection)
    external_cbvs_->selected(messageAs<msgs::CbvSelection>(message));
  return {};
}

std::string TrafficSimulatorNode::takeCommand(const Topic& topic, const AnyMessage& message) {
  if (topic.id == ChannelId::kCbvControl) return external_cbvs_->take(topic, message);
  const EgoAnswer answer = external_ego_->take(message);
  if (answer.control) pacer_->take(ChannelId::kEgoControl, answer.control);
  return answer.refused;
}

/// A fault that a node reports is recorded once, whoever else reports it too; beyond the most of
/// them, that there are more.
void TrafficSimulatorNode::noteFault(const std::string& source, const std::string& given) {
  constexpr std::size_t kMostFaults = 200;
  std::string text = traffic::shownFaultText(given);
  if (noted_faults_.size() > kMostFaults || noted_faults_.count(text) != 0) return;
  if (noted_faults_.size() == kMostFaults)
    text = "more than " + std::to_string(kMostFaults) + " faults; the rest is not named";
  noted_faults_.insert(text);
  ROS_WARN("%s: %s", traffic::shownSource(source).c_str(), text.c_str());
  world_->recordFault(source, text);
}

std::optional<SessionEnd> TrafficSimulatorNode::externalPlannerGone() const {
  if (!published_) return std::nullopt;
  for (const auto& [topic, commands] : commands_) {
    if (commands.getNumPublishers() > 0 &&
        !connections_.stoppedListening(gate_.firstSender(topic.name())))
      continue;
    return SessionEnd{SessionStatus::kError, answererOf(topic, graph_),
                      "no node publishes on " + topic.name() + " any more"};
  }
  return std::nullopt;
}

std::optional<SessionEnd> TrafficSimulatorNode::waitForParticipants() {
  watch_.setOtherCause([this] { return externalPlannerGone(); });
  const auto missing = [this] {
    std::vector<Missing> missing = missingPlanners();
    for (Missing& node : watch_.notReady()) missing.push_back(std::move(node));
    return missing;
  };
  auto end = watch_.waitFor(missing, limits_.start);
  if (end && end->status == SessionStatus::kError && !masterAnswers())
    end = SessionEnd{SessionStatus::kError, "rosmaster", kNoMaster + ("; " + end->text)};
  return end;
}

/// The user's own nodes that do not publish yet. Commands of an ego that go elsewhere are named at
/// once, and again at the end of patience.
std::vector<Missing> TrafficSimulatorNode::missingPlanners() {
  std::vector<Missing> missing;
  for (const auto& [topic, commands] : commands_) {
    if (commands.getNumPublishers() > 0) continue;
    const bool of_cbv = topic.id == ChannelId::kCbvControl;
    const std::string elsewhere = of_cbv ? "" : misdirected();
    const std::string example = of_cbv ? "examples/external_cbv.py" : "external_ego_node";
    missing.push_back(
        {answererOf(topic, graph_),
         "no node publishes " + topic.name() + " yet; " +
             (elsewhere.empty() ? "start yours (" + example + " is an example)" : elsewhere)});
  }
  return missing;
}

std::string TrafficSimulatorNode::misdirected() {
  constexpr double kAskAgainAfter = 1.0;  // [s]
  if (!asked_master_ || secondsSince(*asked_master_) > kAskAgainAfter) {
    const std::string misdirected = misdirectedCommands(graph_);
    ROS_ERROR_COND(!misdirected.empty() && misdirected != misdirected_, "%s", misdirected.c_str());
    misdirected_ = misdirected;
    asked_master_ = std::chrono::steady_clock::now();
  }
  return misdirected_;
}

void TrafficSimulatorNode::runTicks() {
  const core::TimedStage stage("rest");
  publishTick();
  while (world_->snapshot().status == SessionStatus::kRunning) {
    std::optional<SessionEnd> end = waitForAnswers();
    if (!end) end = holdBack();
    if (!end) end = advance();
    if (end) endSession(*end);
    publishTick();
  }
}

std::optional<SessionEnd> TrafficSimulatorNode::waitForAnswers() {
  const core::TimedStage stage("wait");
  return pacer_->wait();
}

/// Waits while the session is paused, or ahead of the pace that it is to keep at most.
std::optional<SessionEnd> TrafficSimulatorNode::holdBack() {
  using Clock = session::SessionControl::Clock;
  session::SessionControl& control = world_->control();
  while (!control.quitting()) {
    const Clock::time_point now = Clock::now();
    const Clock::duration wait = control.holdBack(world_->snapshot().time, now);
    if (wait == Clock::duration::zero()) return std::nullopt;
    diagnostics_->update();
    if (auto cause = watch_.sleepUntil(now + wait)) return cause;
  }
  return SessionEnd{SessionStatus::kInterrupted, "user", "interrupted"};
}

void TrafficSimulatorNode::publishTick() {
  const core::TimedStage stage("publish");
  const traffic::TrafficSnapshot& snapshot = world_->snapshot();
  const bool final = snapshot.status != SessionStatus::kRunning;
  if (final) pacer_->close();
  msgs::TrafficSnapshot message = toMsg(snapshot);
  message.late_answers = pacer_->late();
  if (final) addTotals(message);
  rosgraph_msgs::Clock clock;
  clock.clock = message.header.stamp;
  published_ = shared(std::move(message));
  if (clock_) clock_.publish(shared(clock));
  gate_.setNewestTick(published_->tick, setup_->options().simulation_step);
  services_->show(published_);
  display_.publish(snapshot);
  if (external_ego_) external_ego_->published(snapshot);
  if (external_cbvs_) external_cbvs_->published(*published_);
  traffic_.publish(published_);
  pacer_->published(published_);
  steered_ += snapshot.steering.size();
  diagnostics_->update();
}

/// How much was ignored, in the last snapshot.
void TrafficSimulatorNode::addTotals(msgs::TrafficSnapshot& message) const {
  for (const std::string& text : gate_.totals()) {
    message.faults.emplace_back();
    message.faults.back().tick = message.tick;
    message.faults.back().source = kTrafficSimulatorNode;
    message.faults.back().text = text;
  }
}

/// Moves the world to the next tick. An ego that came to stand after a node was last heard may
/// brake for want of that node: it is not blocked before the node answers again; otherwise its
/// silence ends the session. Returns what an observer lacks of a session that has come to its end.
std::optional<SessionEnd> TrafficSimulatorNode::advance() {
  const TickInput input = pacer_->advance();
  const std::optional<double> since = world_->egoStandsSince();
  world_->withholdBlocked(since && pacer_->silentFor(world_->snapshot().time - *since));
  world_->advance(input.selection ? &*input.selection : nullptr, input.actions);
  if (world_->snapshot().status == SessionStatus::kRunning) return std::nullopt;
  return pacer_->waitForObservers();
}

void TrafficSimulatorNode::endSession(const SessionEnd& end) {
  const std::string text =
      traffic::shownFaultText(end.text + pluginsOf(end.source, setup_->options()));
  ROS_ERROR_COND(end.status == SessionStatus::kError, "%s: %s",
                 traffic::shownSource(end.source).c_str(), text.c_str());
  world_->end(end.status, {world_->snapshot().tick, end.source, text});
}

void TrafficSimulatorNode::waitForResult() {
  const bool interrupted = world_->snapshot().status == SessionStatus::kInterrupted;
  watch_.waitForObservers(interrupted ? kInterruptedPatience : limits_.answer);
  if (participants_.finished(kMetricsNode)) return;
  if (hostedNodeRuns(kMetricsNode)) return handReserveOver();
  writeResultAlone();
}

/// A thread that hangs cannot be ended alone, and may go on writing: the process ends here and now,
/// and who launched it writes the result.
void TrafficSimulatorNode::handReserveOver() {
  ROS_FATAL(
      "metrics_node hangs, and with it the process of all nodes; scripts/session writes the "
      "result from %s/.reserve",
      results_.c_str());
  reserve_->handOver(published_);
  std::_Exit(core::ExitCode::kRunTimeError);
}

void TrafficSimulatorNode::writeResultAlone() {
  leaveOutPluginMetrics();
  if (!reserve_->adopt(published_, pacer_->elapsed())) return;
  ROS_WARN("The metrics node did not finish; the result is the simulator's own, in %s",
           results_.c_str());
}

int runTrafficSimulator(StopSignal& stop) {
  const Parameters parameters = Parameters::ofThisNode();
  try {
    requireHeededLaunchArguments();
    return runNodeObject<TrafficSimulatorNode>(parameters, stop);
  } catch (const core::InputError&) {
    writeRefusal(parameters.text("results"));
    noteRefusal();
    throw;
  }
}

void TrafficSimulatorNode::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  const traffic::TrafficSnapshot& snapshot = world_->snapshot();
  const bool troubled = !noted_faults_.empty() || pacer_->late() > 0;
  status.summary(troubled ? DiagnosticStatus::WARN : DiagnosticStatus::OK,
                 traffic::toText(snapshot.status));
  status.add("tick", snapshot.tick);
  status.add("vehicles", snapshot.vehicles.size());
  status.add("pace", paceText(world_->control().state()));
  status.add("changes steered", steered_);
  status.add("late answers", pacer_->late());
  for (const auto& [channel, milliseconds] : pacer_->waits())
    status.add("wait for " + channel + " [ms]", core::formatFixed(milliseconds, 3));
  status.add("faults that nodes reported", noted_faults_.size());
}

int TrafficSimulatorNode::exitCode() const {
  const SessionStatus status = world_->snapshot().status;
  if (status == SessionStatus::kError) return core::ExitCode::kRunTimeError;
  return status == SessionStatus::kInterrupted ? core::ExitCode::kInterrupted
                                               : core::ExitCode::kPassed;
}

}  // namespace cdiff::node_graph
