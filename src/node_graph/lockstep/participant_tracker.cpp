// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/lockstep/participant_tracker.h"

#include <algorithm>
#include <chrono>

#include "e2e_cdiff/Heartbeat.h"
#include "node_graph/lockstep/hosted_nodes.h"
#include "node_graph/lockstep/message_gate.h"
#include "node_graph/messages/topics.h"

namespace cdiff::node_graph {
namespace {

constexpr std::chrono::seconds kBeatPeriod{1};

}  // namespace

HeartbeatPublisher::HeartbeatPublisher(ros::NodeHandle& node, double timeout)
    : publisher_(
          node.advertise<::e2e_cdiff::Heartbeat>(Topic(ChannelId::kHeartbeat).name(), 1, true)),
      thread_(
          [this, timeout, name = baseName(nodeName())] { publishUntilStopped(name, timeout); }) {}

HeartbeatPublisher::~HeartbeatPublisher() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void HeartbeatPublisher::publishUntilStopped(const std::string& node, double timeout) {
  const auto begin = std::chrono::steady_clock::now();
  ::e2e_cdiff::Heartbeat message;
  message.node = node;
  message.timeout = timeout;
  std::unique_lock<std::mutex> lock(mutex_);
  while (!stopping_) {
    message.uptime =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    publisher_.publish(message);
    ++message.count;
    changed_.wait_for(lock, kBeatPeriod, [this] { return stopping_; });
  }
}

void SilenceWatch::heard(double timeout) {
  timeout_ = timeout;
  silence_ = 0.0;
}

bool SilenceWatch::silent(double now) {
  silence_ += std::min(now - last_look_, kLongestLook);
  last_look_ = now;
  return everHeard() && silence_ > timeout_;
}

ParticipantTracker::ParticipantTracker(const std::vector<std::string>& nodes) {
  for (const std::string& node : nodes) entries_[node];
}

void ParticipantTracker::note(const ::e2e_cdiff::TickAck& message, Clock::time_point now) {
  const auto found = entries_.find(message.node);
  if (found == entries_.end()) return;
  Entry& entry = found->second;
  entry.heard_at = now;
  using Ack = ::e2e_cdiff::TickAck;
  if (message.kind == Ack::WAITING) entry.waiting_for = message.text;
  if (message.kind == Ack::READY) entry.ready = true;
  if (message.kind == Ack::ACKNOWLEDGED) entry.acknowledged = message.tick;
  if (message.kind == Ack::FINISHED) entry.finished = true;
  if (message.kind == Ack::ERROR && !error_) error_ = Error{message.node, message.text};
}

std::vector<std::string> ParticipantTracker::notReady() const {
  std::vector<std::string> texts;
  for (const bool silent : {true, false}) {  // a node that never came is why others wait
    for (const auto& [node, entry] : entries_) {
      if (entry.ready || entry.waiting_for.empty() != silent) continue;
      texts.push_back(node +
                      (silent ? " has not started" : " is not ready (" + entry.waiting_for + ")"));
    }
  }
  return texts;
}

std::vector<std::string> ParticipantTracker::notAcknowledged(std::uint64_t tick) const {
  std::vector<std::string> nodes;
  for (const auto& [node, entry] : entries_) {
    if (isObserver(node) && (!entry.acknowledged || *entry.acknowledged < tick))
      nodes.push_back(node);
  }
  return nodes;
}

std::uint64_t ParticipantTracker::acknowledgedByAll() const {
  std::optional<std::uint64_t> least;
  for (const auto& [node, entry] : entries_) {
    if (!isObserver(node)) continue;
    const std::uint64_t tick = entry.acknowledged.value_or(0);
    least = std::min(least.value_or(tick), tick);
  }
  return least.value_or(0);
}

std::vector<std::string> ParticipantTracker::notFinished() const {
  std::vector<std::string> nodes;
  for (const auto& [node, entry] : entries_) {
    if (isObserver(node) && !entry.finished) nodes.push_back(node);
  }
  return nodes;
}

bool ParticipantTracker::finished(const std::string& node) const {
  const auto found = entries_.find(node);
  return found != entries_.end() && found->second.finished;
}

bool ParticipantTracker::heard(const std::string& node) const {
  const auto found = entries_.find(node);
  return found != entries_.end() && found->second.heard_at;
}

std::vector<std::string> ParticipantTracker::silent(double seconds, Clock::time_point now) const {
  std::vector<std::string> nodes;
  for (const auto& [node, entry] : entries_) {
    if (entry.finished || !entry.heard_at) continue;
    if (std::chrono::duration<double>(now - *entry.heard_at).count() > seconds)
      nodes.push_back(node);
  }
  return nodes;
}

}  // namespace cdiff::node_graph
