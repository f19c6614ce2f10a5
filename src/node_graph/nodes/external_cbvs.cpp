// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/nodes/external_cbvs.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "e2e_cdiff/planning/planner_descriptor.h"

namespace cdiff::node_graph {
namespace {

constexpr std::uint64_t kKeptCommandTicks = 400;  // of selections and commands

/// Drops what is older than the kept ticks.
template <class Map, class Key>
void dropBefore(Map& map, const Key& key) {
  map.erase(map.begin(), map.lower_bound(key));
}

}  // namespace

ExternalCbvs::ExternalCbvs(double simulation_step, bool paced, Give give)
    : simulation_step_(simulation_step), paced_(paced), give_(std::move(give)) {}

void ExternalCbvs::published(const msgs::TrafficSnapshot& snapshot) {
  newest_ = snapshot.tick;
  if (!snapshot.decision_tick) return;
  decision_ = snapshot.tick;
  published_at_[snapshot.tick] = Clock::now();
  const std::uint64_t oldest = newest_ - std::min(newest_, kKeptCommandTicks);
  dropBefore(published_at_, oldest);
  dropBefore(selections_, oldest);
  dropBefore(early_, std::pair<std::uint64_t, Topic>(oldest, {ChannelId::kCbvControl, 0}));
}

void ExternalCbvs::selected(const msgs::CbvSelection::ConstPtr& selection) {
  const std::uint64_t tick = selection->tick;
  if (!selections_.emplace(tick, selection).second) return;
  const auto begin = early_.lower_bound({tick, {ChannelId::kCbvControl, 0}});
  auto end = begin;
  for (; end != early_.end() && end->first.first == tick; ++end)
    give(end->first.second, end->second, *selection);
  early_.erase(begin, end);
}

std::string ExternalCbvs::take(const Topic& topic, const AnyMessage& message) {
  const auto said = topic.row().type.tick(message, simulation_step_);
  if (!said && !paced_ && newest_ != 0) {
    return "it has neither tick nor stamp, so it counts for tick 0, and the session is at tick " +
           std::to_string(newest_) + "; copy tick from the /traffic message that it answers";
  }
  const std::uint64_t tick = said.value_or(decision_);
  if (tick > newest_) return "it answers tick " + std::to_string(tick) + ", which has not been";
  const Command command{messageAs<msgs::ControlAction>(message), Clock::now()};
  const auto selection = selections_.find(tick);
  if (selection == selections_.end())
    early_.emplace(std::make_pair(tick, topic), command);
  else
    give(topic, command, *selection->second);
  return {};
}

/// Full braking with a fault where the command names another vehicle than the slot holds.
void ExternalCbvs::address(const Topic& topic, const std::string& vehicle_id,
                           msgs::ControlAction& control) const {
  if (!control.vehicle_id.empty() && control.vehicle_id != vehicle_id) {
    const traffic::ControlAction safe = traffic::ControlAction::failSafe();
    control.throttle = safe.throttle;
    control.steer = safe.steer;
    control.brake = safe.brake;
    control.fault = topic.name() + ": the command is for vehicle '" +
                    core::shortened(control.vehicle_id) + "', and the slot holds '" + vehicle_id +
                    "'; full braking instead";
  }
  control.slot = topic.slot;
  control.vehicle_id = vehicle_id;
  control.planner = std::string("cbv:") + planning::kExternalPlanner;
}

/// The latency is the wall time from the tick's publication to the command, where the planner does
/// not say how long it planned.
void ExternalCbvs::give(const Topic& topic, const Command& command,
                        const msgs::CbvSelection& selection) const {
  const auto assignment = std::find_if(selection.assignments.begin(), selection.assignments.end(),
                                       [&](const auto& one) { return one.slot == topic.slot; });
  if (assignment == selection.assignments.end()) return;
  msgs::ControlAction control = *command.control;
  control.header = selection.header;
  control.tick = selection.tick;
  address(topic, assignment->vehicle_id, control);
  const auto out = published_at_.find(selection.tick);
  const bool said = std::isfinite(control.planner_latency_ms) && control.planner_latency_ms > 0.0;
  if (!said && out != published_at_.end()) {
    control.planner_latency_ms =
        std::chrono::duration<double, std::milli>(command.came - out->second).count();
  }
  give_(topic, shared(std::move(control)));
}

}  // namespace cdiff::node_graph
