// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/lockstep/heartbeat.h"

#include <algorithm>
#include <chrono>

#include "e2e_cdiff/Heartbeat.h"
#include "ros/lockstep/message_gate.h"
#include "ros/messages/topics.h"

namespace cdiff::ros {
namespace {

constexpr std::chrono::seconds kBeatPeriod{1};

}  // namespace

HeartbeatPublisher::HeartbeatPublisher(::ros::NodeHandle& node, double timeout)
    : publisher_(
          node.advertise<::e2e_cdiff::Heartbeat>(Topic(ChannelId::kHeartbeat).name(), 1, true)),
      thread_([this, timeout] { publishUntilStopped(timeout); }) {}

HeartbeatPublisher::~HeartbeatPublisher() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void HeartbeatPublisher::publishUntilStopped(double timeout) {
  const auto begin = std::chrono::steady_clock::now();
  ::e2e_cdiff::Heartbeat message;
  message.node = baseName(::ros::this_node::getName());
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

}  // namespace cdiff::ros
