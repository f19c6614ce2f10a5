// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/lockstep/session_watch.h"

#include <algorithm>

#include "core/text.h"
#include "node_graph/lockstep/hosted_nodes.h"
#include "node_graph/node_main.h"
#include "node_graph/session_graph.h"

namespace cdiff::node_graph {
namespace {

using traffic::SessionStatus;

constexpr double kSilence = 5.0;  // [s] of wall time: a node that waits says so every second

/// The name that the text begins with owes it.
Missing missingOf(const std::string& text) { return {text.substr(0, text.find(' ')), text}; }

}  // namespace

std::optional<SessionEnd> SessionWatch::disturbance() {
  if (stop_.raised()) {
    if (masterAnswers()) return SessionEnd{SessionStatus::kInterrupted, "user", "interrupted"};
    return SessionEnd{SessionStatus::kError, "rosmaster", kNoMaster};
  }
  if (const auto& error = participants_.error())
    return SessionEnd{SessionStatus::kError, error->node, error->text};
  if (const auto left = connections_.left(); !left.empty())
    return SessionEnd{SessionStatus::kError, left.front(), "the node left the session"};
  if (other_cause_) {
    if (auto cause = other_cause_()) return cause;
  }
  if (!ros::ok())
    return SessionEnd{SessionStatus::kInterrupted, kTrafficSimulatorNode, "ROS was shut down"};
  return std::nullopt;
}

std::vector<Missing> SessionWatch::notReady() const {
  std::vector<Missing> missing;
  for (const std::string& text : participants_.notReady()) missing.push_back(missingOf(text));
  for (const std::string& text : connections_.missing()) missing.push_back(missingOf(text));
  return missing;
}

std::optional<SessionEnd> SessionWatch::waitFor(const MissingNow& missing_now, double seconds,
                                                const std::function<void()>& meanwhile) {
  const Clock::time_point begin = Clock::now();
  while (true) {
    if (auto cause = disturbance()) return cause;
    const std::vector<Missing> missing = missing_now();
    if (missing.empty()) return std::nullopt;
    if (secondsSince(begin) > seconds) return endOfPatience(missing, seconds);
    if (meanwhile) meanwhile();
    spin(kSpinPeriod);
  }
}

std::optional<SessionEnd> SessionWatch::sleepUntil(Clock::time_point due) {
  while (true) {
    if (auto cause = disturbance()) return cause;
    const double left = -secondsSince(due);
    if (left <= 0.0) return std::nullopt;
    spin(std::min(left, kSpinPeriod));
  }
}

SessionEnd SessionWatch::endOfPatience(const std::vector<Missing>& missing, double seconds) {
  std::vector<std::string> texts;
  for (const Missing& item : missing) texts.push_back(item.what);
  const std::vector<std::string> silent = participants_.silent(std::min(kSilence, 0.8 * seconds));
  blamed_.insert(silent.begin(), silent.end());
  for (const Missing& item : missing) {
    if (!participants_.heard(item.node)) blamed_.insert(item.node);
  }
  for (const std::string& node : blamed_) killLaunchedProcess(node);
  const std::string culprit = silent.empty() ? missing.front().node : silent.front();
  blamed_.insert(culprit);
  return {SessionStatus::kError, culprit,
          "nothing came for " + core::formatNumber(seconds) + " s: " + core::joinText(texts, "; ")};
}

bool SessionWatch::observersPending(double waited) const {
  for (const std::string& node : participants_.notFinished()) {
    const bool hopeless = connections_.hasLeft(node) || blamed_.count(node) > 0;
    const auto begins = [&] { return waited < kSilence && nodeRuns(node); };
    if (!hopeless && (participants_.heard(node) || begins())) return true;
  }
  return false;
}

void SessionWatch::waitForObservers(double seconds) {
  const Clock::time_point begin = Clock::now();
  while (observersPending(secondsSince(begin)) && ros::ok() && secondsSince(begin) < seconds)
    spin(kSpinPeriod);
  for (const std::string& node : participants_.notFinished()) killLaunchedProcess(node);
  for (const std::string& node : participants_.silent(kSilence)) killLaunchedProcess(node);
}

}  // namespace cdiff::node_graph
