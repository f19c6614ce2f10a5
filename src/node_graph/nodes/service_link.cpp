// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/nodes/service_link.h"

#include <algorithm>

#include "core/text.h"
#include "e2e_cdiff/GetSimulationState.h"
#include "e2e_cdiff/SetSimulationState.h"
#include "e2e_cdiff/SteerSession.h"
#include "e2e_cdiff/StepSimulation.h"
#include "node_graph/messages/topics.h"
#include "ros/ros.h"
#include "session/steered_cbvs.h"

namespace cdiff::node_graph {
namespace {

using Kind = watch::PageCommand::Kind;

constexpr std::size_t kMostCommands = 100;  // that wait
constexpr auto kLookPeriod = std::chrono::milliseconds(200);
constexpr auto kInterest = std::chrono::seconds(1);  // in the state, after it was asked for

/// Why the service did not do it; empty when it did.
template <class Service>
std::string refusalOf(const char* name, Service& service) {
  if (!ros::service::call(name, service)) return "the traffic simulator does not answer";
  const auto& result = service.response.result;
  if (result.result == msgs::Result::RESULT_OK) return {};
  return result.error_message.empty() ? "the traffic simulator refused it" : result.error_message;
}

std::string setState(std::uint8_t state) {
  msgs::SetSimulationState service;
  service.request.state.state = state;
  return refusalOf("set_simulation_state", service);
}

std::string steer(const std::string& what, const std::string& value) {
  msgs::SteerSession service;
  service.request.what = what;
  service.request.value = value;
  return refusalOf("steer", service);
}

std::string callFor(const watch::PageCommand& command) {
  switch (command.kind) {
    case Kind::kPause:
      return setState(msgs::SimulationState::STATE_PAUSED);
    case Kind::kResume:
      return setState(msgs::SimulationState::STATE_PLAYING);
    case Kind::kPace:
      return steer("pace", core::formatNumber(command.pace));
    case Kind::kSteer:
      return steer(command.what, command.value);
    case Kind::kStep:
      break;
  }
  msgs::StepSimulation service;
  service.request.steps = command.ticks;
  return refusalOf("step_simulation", service);
}

}  // namespace

ServiceLink::ServiceLink(double at_most) : pace_(at_most), thread_([this] { work(); }) {}

ServiceLink::~ServiceLink() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    over_ = true;
    changed_.notify_all();
  }
  thread_.join();
}

void ServiceLink::send(const watch::PageCommand& command, Answer answer) {
  Answer replaced;
  bool full = false;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto same = std::find_if(queue_.begin(), queue_.end(), [&](const auto& waiting) {
      return command.kind == Kind::kSteer && waiting.first.kind == Kind::kSteer &&
             waiting.first.what == command.what && session::SteeredCbvs::concerns(command.what);
    });
    full = same == queue_.end() && queue_.size() >= kMostCommands;
    if (same != queue_.end()) {
      same->first = command;
      replaced = std::exchange(same->second, answer);
    } else if (!full) {
      queue_.emplace_back(command, answer);
    }
    changed_.notify_all();
  }
  if (replaced) replaced("");
  if (full) answer("too many commands wait for the traffic simulator");
}

std::string ServiceLink::state() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  wanted_ = Clock::now();
  return state_;
}

double ServiceLink::pace() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return pace_;
}

void ServiceLink::work() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!over_) {
    changed_.wait_for(lock, kLookPeriod, [this] { return over_ || !queue_.empty(); });
    while (!queue_.empty()) {
      const auto [command, answer] = std::move(queue_.front());
      queue_.pop_front();
      lock.unlock();
      const std::string refused = callFor(command);
      lock.lock();
      if (refused.empty() && command.kind == Kind::kPace) pace_ = command.pace;
      lock.unlock();
      look();
      answer(refused);
      lock.lock();
    }
    if (over_ || Clock::now() - wanted_ > kInterest) continue;
    lock.unlock();
    look();
    lock.lock();
  }
}

/// Asks how the session stands.
void ServiceLink::look() {
  using Code = msgs::SimulationState;
  msgs::GetSimulationState service;
  if (!ros::service::call("get_simulation_state", service)) return;
  const std::uint8_t state = service.response.state.state;
  const std::lock_guard<std::mutex> lock(mutex_);
  state_ = state == Code::STATE_PAUSED    ? "paused"
           : state == Code::STATE_PLAYING ? "playing"
                                          : "over";
}

}  // namespace cdiff::node_graph
