// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// What a session waits for, how long, and who is to blame when it does not come.
#include <algorithm>

#include "core/text.h"
#include "node_graph/lockstep/node_process.h"
#include "node_graph/node_main.h"
#include "node_graph/nodes/traffic_simulator_node.h"

namespace cdiff::node_graph {
namespace {

using traffic::SessionStatus;

constexpr double kSilence = 5.0;  // [s] of wall time: a node that waits says so every second
constexpr double kInterruptedPatience =
    10.0;  // [s] for the observers' files; roslaunch ends us 15 s after the user

}  // namespace

/// What ends a session at once.
std::optional<TrafficSimulatorNode::Ending> TrafficSimulatorNode::disturbance() {
  if (stop_.raised()) {
    if (masterAnswers()) return ending(SessionStatus::kInterrupted, "user", "interrupted");
    return ending(SessionStatus::kError, "rosmaster", kNoMaster);
  }
  if (book_.error()) return ending(SessionStatus::kError, book_.error()->node, book_.error()->text);
  if (!connections_.left().empty()) {
    return ending(SessionStatus::kError, connections_.left().front(), "the node left the session");
  }
  if (graph_.external_ego && published_ && egoGone()) {
    return ending(SessionStatus::kError, "the external ego planner",
                  "no node publishes on " + Topic(ChannelId::kEgoControl).name() + " any more");
  }
  if (!ros::ok())
    return ending(SessionStatus::kInterrupted, kTrafficSimulatorNode, "ROS was shut down");
  return std::nullopt;
}

bool TrafficSimulatorNode::egoGone() const {
  return ego_control_.getNumPublishers() == 0 ||
         connections_.stoppedListening(gate_.firstSender(Topic(ChannelId::kEgoControl).name()));
}

/// Something is missing for too long. Of several nodes the one to blame says nothing at all, not
/// even that it waits; it is not waited for again.
TrafficSimulatorNode::Ending TrafficSimulatorNode::endOfPatience(
    const std::vector<Missing>& missing, double seconds) {
  std::vector<std::string> texts;
  for (const Missing& item : missing) texts.push_back(item.what);
  const std::vector<std::string> silent = book_.silent(std::min(kSilence, 0.8 * seconds));
  blamed_.insert(silent.begin(), silent.end());
  for (const Missing& item : missing) {
    if (!book_.heard(item.node)) blamed_.insert(item.node);
  }
  for (const std::string& node : blamed_) killLaunchedProcess(node);
  const std::string culprit = silent.empty() ? missing.front().node : silent.front();
  blamed_.insert(culprit);
  return ending(
      SessionStatus::kError, culprit,
      "nothing came for " + core::formatNumber(seconds) + " s: " + core::joinText(texts, "; "));
}

std::optional<TrafficSimulatorNode::Ending> TrafficSimulatorNode::waitFor(
    const MissingNow& missing_now, double seconds) {
  const Clock::time_point begin = Clock::now();
  while (true) {
    if (const auto cause = disturbance()) return cause;
    const std::vector<Missing> missing = missing_now();
    if (missing.empty()) return std::nullopt;
    if (secondsSince(begin) > seconds) return endOfPatience(missing, seconds);
    sendAgainForLateListener();
    spin(kSpinPeriod);
  }
}

/// Neither who was blamed nor who was never heard is waited for. Who has not finished in time may
/// not write beside us, nor hold up the end of the launch.
void TrafficSimulatorNode::waitForObservers() {
  const bool interrupted = world_->snapshot().status == SessionStatus::kInterrupted;
  const double limit = interrupted ? kInterruptedPatience : limits_.answer;
  const Clock::time_point begin = Clock::now();
  const auto pending = [this] {
    for (const std::string& node : book_.notFinished()) {
      const bool hopeless = connections_.hasLeft(node) || blamed_.count(node) > 0;
      if (!hopeless && book_.heard(node)) return true;
    }
    return false;
  };
  while (pending() && ros::ok() && secondsSince(begin) < limit) spin(kSpinPeriod);
  for (const std::string& node : book_.notFinished()) killLaunchedProcess(node);
  for (const std::string& node : book_.silent(kSilence)) killLaunchedProcess(node);
  if (!book_.finished(kMetricsNode)) writeResultAlone(world_->snapshot());
}

void TrafficSimulatorNode::writeResultAlone(const traffic::TrafficSnapshot& snapshot) {
  session::TickRecord record;
  record.snapshot = &snapshot;
  reserve_->observe(record);
  reserve_->adopt(secondsSince(begin_));
  ROS_WARN("The metrics node did not finish; the result is the simulator's own, in %s",
           results_.c_str());
}

}  // namespace cdiff::node_graph
