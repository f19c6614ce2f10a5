// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/replay_ros.h"

#include <algorithm>
#include <system_error>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "ros/conversions.h"
#include "ros/decision_book.h"
#include "ros/image_conversions.h"
#include "ros/launched_nodes.h"
#include "ros/markers.h"
#include "ros/replay.h"
#include "ros/session_files.h"
#include "ros/session_parts.h"
#include "ros/spinning.h"
#include "ros/tick_record.h"
#include "rosgraph_msgs/Clock.h"

namespace cdiff::ros {
namespace {

namespace fs = std::filesystem;

constexpr double kPatience = 30.0;  // [s] of wall time for the metrics node to do its next thing
constexpr double kFarewell = 5.0;   // [s] for its files when the replay is interrupted
constexpr double kHeartbeatTimeout = 10.0;  // [s] until the metrics node takes us for lost
constexpr double kStraggle = 0.1;           // [s] for the answers to a tick that lacks some
constexpr const char* kClockTopic = "/clock";

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

/// Who takes part in a replay: the metrics node works, and listens to what the others said.
SessionGraph replayGraph(SessionGraph graph) {
  auto& nodes = graph.participants;
  nodes.erase(std::remove(nodes.begin(), nodes.end(), kRecorderNode), nodes.end());
  if (!graph.has(kMetricsNode)) nodes.emplace_back(kMetricsNode);
  return graph;
}

}  // namespace

ReplayRos::ReplayRos(const Parameters& parameters, StopSignal& stop)
    : stop_(stop),
      rate_(rateOf(parameters)),
      bag_(bagOf(parameters)),
      session_(bag_),
      graph_(replayGraph(session_.graph())),
      book_(std::vector<std::string>{kMetricsNode}),
      heartbeat_(node_, kHeartbeatTimeout),
      display_(node_) {
  results_ = folderOf(parameters, session_.setup().options());
  const bool overwrite = parameters.flag("overwrite", false);
  requireReplayFolder(bag_, results_, overwrite);
  folder_ = std::make_unique<record::ResultFolder>(results_, kReplayLaunch, overwrite);
  if (graph_.has(kCameraNode)) display_.showCameras(session_.setup().options().camera);
}

/// Of those who listen live, the metrics node alone is counted on.
template <class Message>
::ros::Publisher ReplayRos::offer(const std::string& topic, bool latch) {
  const std::vector<std::string> nodes = listeners(topic, graph_);
  const bool counted = std::find(nodes.begin(), nodes.end(), kMetricsNode) != nodes.end();
  const std::vector<std::string> expected =
      counted ? std::vector<std::string>{kMetricsNode} : std::vector<std::string>();
  return topics_[topic] = connections_.advertise<Message>(node_, topic, expected, latch);
}

void ReplayRos::advertise() {
  topics_[kClockTopic] = node_.advertise<rosgraph_msgs::Clock>(kClockTopic, 100);
  offer<msgs::SessionInfo>(kSessionTopic, true);
  offer<msgs::TrafficSnapshot>(kTrafficTopic, true);
  offer<nav_msgs::Path>(kEgoRouteTopic, true);
  if (graph_.recordsDecisions()) offer<msgs::DecisionRecord>(kDecisionRecordTopic);
  offer<msgs::CbvSelection>(kSelectionTopic);
  offer<visualization_msgs::MarkerArray>(kRolloutMarkersTopic);
  if (graph_.cbvsSee()) offer<msgs::GuidanceReport>(kGuidanceTopic);
  for (int slot = kEgoSlot; slot < graph_.max_cbv; ++slot) advertiseSlot(slot);
  gate_.setReport([](const std::string& text) { ROS_WARN("%s", text.c_str()); });
  acks_ = gate_.subscribe<msgs::TickAck>(node_, kTickAckTopic, {siblingNode(kMetricsNode)},
                                         [this](const auto& ack) { book_.note(*ack); });
}

void ReplayRos::advertiseSlot(int slot) {
  const bool ego = slot == kEgoSlot;
  offer<msgs::ControlAction>(ego ? kEgoControlTopic : cbvControlTopic(slot));
  if (!ego) offer<msgs::Rollout>(cbvRolloutTopic(slot));
  if (!(ego ? graph_.egoPlansFromImages() : graph_.cbvsPlanFromImages())) return;
  offer<sensor_msgs::Image>(imageTopic(slot));
  offer<sensor_msgs::CameraInfo>(cameraInfoTopic(slot));
}

void ReplayRos::publishSession() {
  msgs::SessionInfo info = session_.info();
  info.deployment = replayDeployment(kReplayLaunch, info);
  info.results_folder = results_.string();
  putGraph(graph_, info);
  topics_.at(kSessionTopic).publish(boost::make_shared<const msgs::SessionInfo>(info));
  topics_.at(kEgoRouteTopic).publish(toPathMsg(session_.setup().egoRoute()));
}

void ReplayRos::publishTick(const msgs::TrafficSnapshot::ConstPtr& snapshot) {
  rosgraph_msgs::Clock clock;
  clock.clock = snapshot->header.stamp;
  topics_.at(kClockTopic).publish(clock);
  topics_.at(kTrafficTopic).publish(snapshot);
  if (snapshot->decision_tick) publishAnswers(*snapshot);
  display_.publish(fromMsg(*snapshot));
}

void ReplayRos::publishAnswers(const msgs::TrafficSnapshot& snapshot) {
  const TickAnswers& answers = session_.answers();
  if (graph_.recordsDecisions()) {
    const auto record = answers.decision(snapshot.tick);  // earlier versions recorded none
    topics_.at(kDecisionRecordTopic)
        .publish(record ? record
                        : boost::make_shared<const msgs::DecisionRecord>(
                              punctualRecord(snapshot, answers)));
  }
  if (const auto guidance = answers.guidance(snapshot.tick))
    topics_.at(kGuidanceTopic).publish(guidance);
  for (int slot = kEgoSlot; slot < graph_.max_cbv; ++slot) publishSlot(slot, snapshot.tick);
  if (const auto selection = answers.selection(snapshot.tick))
    topics_.at(kSelectionTopic).publish(selection);
  if (topics_.at(kRolloutMarkersTopic).getNumSubscribers() > 0) publishPlans(snapshot);
}

void ReplayRos::publishSlot(int slot, std::uint64_t tick) {
  const TickAnswers& answers = session_.answers();
  const bool ego = slot == kEgoSlot;
  if (const auto control = answers.cbv(slot, tick))
    topics_.at(ego ? kEgoControlTopic : cbvControlTopic(slot)).publish(control);
  const auto rollout = answers.rollout(slot, tick);
  if (!ego && rollout) topics_.at(cbvRolloutTopic(slot)).publish(rollout);
  const auto image = answers.image(slot, tick);
  if (!image) return;
  topics_.at(imageTopic(slot)).publish(image);
  topics_.at(cameraInfoTopic(slot))
      .publish(toCameraInfoMsg(session_.setup().options().camera, image->header));
}

/// The plans of CBVs for rviz, which live their planner's node shows.
void ReplayRos::publishPlans(const msgs::TrafficSnapshot& snapshot) {
  std::vector<planning::PlannedAction> actions = actionsOf(session_.answers().answers(snapshot));
  const auto of_ego = [](const planning::PlannedAction& action) { return action.slot == kEgoSlot; };
  actions.erase(std::remove_if(actions.begin(), actions.end(), of_ego), actions.end());
  topics_.at(kRolloutMarkersTopic).publish(rolloutMarkers(actions, snapshot.time));
}

bool ReplayRos::disturbed() {
  if (book_.error()) ROS_ERROR("%s: %s", book_.error()->node.c_str(), book_.error()->text.c_str());
  if (connections_.hasLeft(kMetricsNode)) ROS_ERROR("the metrics node left the replay");
  failed_ = book_.error() || connections_.hasLeft(kMetricsNode);
  return failed_ || stop_.raised() || !::ros::ok();
}

bool ReplayRos::waitFor(const std::function<std::vector<std::string>()>& missing) {
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

void ReplayRos::waitUntilDue(double time) {
  while (rate_ > 0.0 && !disturbed()) {
    const double left = time / rate_ - secondsSince(begin_);
    if (left <= 0.0) return;
    spin(std::min(left, kSpinPeriod));
  }
}

std::vector<std::string> ReplayRos::notReady() const {
  std::vector<std::string> texts = connections_.missing();
  for (const std::string& text : book_.notReady()) texts.push_back(text);
  return texts;
}

int ReplayRos::run() {
  advertise();
  publishSession();
  if (waitFor([this] { return notReady(); })) tellTicks();
  if (!failed_ && stop_.raised()) tellInterruption();
  return finish();
}

void ReplayRos::tellTicks() {
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

/// A tick that lacks answers is acknowledged when the next one has come.
bool ReplayRos::waitForMetrics(const msgs::TrafficSnapshot& snapshot) {
  const bool last = snapshot.status != msgs::TrafficSnapshot::RUNNING;
  if (!last && !session_.answers().missing(snapshot).empty()) {
    const Clock::time_point begin = Clock::now();
    while (!disturbed() && secondsSince(begin) < kStraggle) spin(kStraggle);
    return !disturbed();
  }
  return waitFor([&] { return last ? book_.notFinished() : book_.notAcknowledged(snapshot.tick); });
}

/// The user has had enough: the metrics node shall write what there is.
void ReplayRos::tellInterruption() {
  if (!last_ || last_->status != msgs::TrafficSnapshot::RUNNING || !::ros::ok()) return;
  const traffic::TrafficSnapshot end =
      endedAfter(fromMsg(*last_), session_.setup().options().simulation_step,
                 traffic::SessionStatus::kInterrupted, {0, "user", "the replay was interrupted"});
  publishTick(boost::make_shared<const msgs::TrafficSnapshot>(toMsg(end)));
  const Clock::time_point begin = Clock::now();
  while (!book_.notFinished().empty() && ::ros::ok() && secondsSince(begin) < kFarewell)
    spin(kSpinPeriod);
}

int ReplayRos::finish() {
  for (const std::string& finding : session_.findings())
    ROS_WARN("bag '%s': %s", bag_.c_str(), finding.c_str());
  if (!failed_ && (stop_.raised() || !::ros::ok())) return 130;
  if (!failed_ && session_.findings().empty()) return 0;
  writeExitCode(results_, 2);
  return 2;
}

int runReplay(StopSignal& stop) {
  const Parameters parameters = Parameters::ofThisNode();
  try {
    requireKnownLaunchArguments();
    return ReplayRos(parameters, stop).run();
  } catch (const core::InputError&) {
    const std::string given = parameters.text("results");
    writeRefusal(given.empty() ? fs::path() : fs::path(parameters.text("folder")) / given);
    throw;
  }
}

}  // namespace cdiff::ros
