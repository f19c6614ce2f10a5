// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/ros/participant.h"

#include <algorithm>
#include <cmath>
#include <exception>

#include "e2e_cdiff/core/text.h"
#include "e2e_cdiff/ros/conversions.h"
#include "e2e_cdiff/ros/session_parts.h"
#include "ros/callback_queue.h"

namespace cdiff::ros {
namespace {

constexpr double kPeriod =
    0.1;  // [s] of wall time between looks at the signals, and between ready messages
constexpr double kStopPatience =
    6.0;  // [s] after a stop signal until a node leaves without a last snapshot
constexpr double kFarewell = 3.0;  // [s] for the last messages to arrive
constexpr double kLead =
    1.0;  // [s] beyond the next decision that answers may come before their snapshot

void spin() { ::ros::getGlobalCallbackQueue()->callAvailable(::ros::WallDuration(kPeriod)); }

}  // namespace

Participant::Participant(StopSignal& stop)
    : stop_(stop), name_(baseName(::ros::this_node::getName())) {
  acks_ = connections_.advertise<msgs::TickAck>(node_, kTickAckTopic, {kTrafficSimulatorNode});
  gate_.setReport([this](const std::string& text) {
    ROS_WARN("%s: %s", name_.c_str(), text.c_str());
    tell(msgs::TickAck::FAULT, lastTick(), text);
  });
  session_input_ = gate_.subscribe<msgs::SessionInfo>(
      node_, kSessionTopic, siblingNodes({kTrafficSimulatorNode}),
      [this](const auto& message) { session_ = message; });
}

int Participant::run() {
  try {
    return waitForSession() ? runSession() : 0;
  } catch (const std::exception& error) {
    return fail(error.what());
  }
}

bool Participant::waitForSession() {
  while (!session_) {
    if (!::ros::ok() || stop_.raised()) return false;
    spin();
  }
  graph_ = graphOf(*session_);
  if (graph_.has(name_)) return true;
  ROS_DEBUG("%s: the session does not need this node", name_.c_str());
  session_input_.shutdown();
  // A node that left would be one that "has died" to roswtf.
  while (::ros::ok() && !stop_.raised() && !simulatorGone()) spin();
  return false;
}

int Participant::runSession() {
  begin(*session_);
  const scenario::ScenarioOptions options = optionsFromMsg(*session_);
  simulation_step_ = options.simulation_step;
  lead_ = static_cast<std::uint64_t>(
      std::llround((options.decision_period + kLead) / simulation_step_));
  traffic_input_ = gate_.subscribe<msgs::TrafficSnapshot>(
      node_, kTrafficTopic, siblingNodes({kTrafficSimulatorNode}),
      [this](const auto& message) { queue(message); });
  ::ros::WallTime stopped_at;
  ::ros::WallTime reported_at;
  while (!handleQueue()) {
    if (!::ros::ok()) return leave(Ending::kStopped);
    if (simulatorGone()) return leave(Ending::kSimulatorGone);
    const ::ros::WallTime now = ::ros::WallTime::now();
    if (stop_.raised() && stopped_at.isZero()) stopped_at = now;
    if (!stopped_at.isZero() && (now - stopped_at).toSec() > kStopPatience)
      return leave(Ending::kStopped);
    if (next_tick_ == 0 && (now - reported_at).toSec() >= kPeriod) {
      reportReady();
      reported_at = now;
    }
    spin();
  }
  return leave(Ending::kFinalSnapshot);
}

void Participant::queue(const Snapshot& snapshot) {
  if (snapshot->tick < next_tick_) return;  // sent again for a late listener
  next_tick_ = snapshot->tick + 1;
  gate_.setNewestTick(snapshot->tick + lead_, simulation_step_);
  snapshots_.push_back(snapshot);
}

/// Answers whether the last snapshot of the session has been handled.
bool Participant::handleQueue() {
  if (leavesOut()) leaveOutdatedOut();
  while (!snapshots_.empty() && handle(snapshots_.front(), snapshots_.size() > 1 && !leavesOut())) {
    final_handled_ = snapshots_.front()->status != msgs::TrafficSnapshot::RUNNING;
    snapshots_.pop_front();
  }
  return final_handled_;
}

/// Answers to older decisions would drive nobody once the newest that can be answered is.
void Participant::leaveOutdatedOut() {
  constexpr std::size_t kMost = 40;  // snapshots that wait for what a decision needs
  const auto newest = std::find_if(snapshots_.rbegin(), snapshots_.rend(), [this](const auto& one) {
    return one->decision_tick && ready(*one);
  });
  if (newest != snapshots_.rend()) snapshots_.erase(snapshots_.begin(), newest.base() - 1);
  const bool last =
      !snapshots_.empty() && snapshots_.back()->status != msgs::TrafficSnapshot::RUNNING;
  if (last) snapshots_.erase(snapshots_.begin(), snapshots_.end() - 1);
  while (snapshots_.size() > kMost) snapshots_.pop_front();
}

int Participant::leave(Ending ending) {
  over_ = true;
  while (isObserver(name_) && !snapshots_.empty() && handle(snapshots_.front(), true))
    snapshots_.pop_front();
  const int exit_code = conclude(ending);
  if (!isObserver(name_) || !::ros::ok()) return exit_code;
  tell(msgs::TickAck::FINISHED, lastTick());
  // The simulator leaves once it knows; until then the message may still be on its way.
  const ::ros::WallTime limit = ::ros::WallTime::now() + ::ros::WallDuration(kFarewell);
  while (!simulatorGone() && ::ros::WallTime::now() < limit) spin();
  return exit_code;
}

int Participant::fail(const std::string& text) {
  ROS_ERROR("%s: %s", name_.c_str(), text.c_str());
  const ::ros::WallTime limit = ::ros::WallTime::now() + ::ros::WallDuration(kFarewell);
  while (::ros::ok() && !simulatorGone() && ::ros::WallTime::now() < limit) {
    tell(msgs::TickAck::ERROR, lastTick(), text);
    spin();
    const bool told =
        !snapshots_.empty() && snapshots_.back()->status != msgs::TrafficSnapshot::RUNNING;
    if (told) break;
  }
  return 2;
}

void Participant::tell(std::uint8_t kind, std::uint64_t tick, const std::string& text) {
  msgs::TickAck message;
  message.node = name_;
  message.kind = kind;
  message.tick = tick;
  message.text = text;
  acks_.publish(message);
}

void Participant::reportReady() {
  const std::string text = missing();
  tell(text.empty() ? msgs::TickAck::READY : msgs::TickAck::WAITING, 0, text);
}

std::string Participant::missing() const {
  std::vector<std::string> texts = connections_.missing();
  for (const ::ros::Subscriber& input : inputs_) {
    if (input.getNumPublishers() == 0)
      texts.push_back("nobody publishes " + input.getTopic() + " yet");
  }
  if (!waitingFor().empty()) texts.push_back(waitingFor());
  return core::joinText(texts, ", ");
}

}  // namespace cdiff::ros
