// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/ros/planner_ros.h"

#include "e2e_cdiff/planning/planner_factory.h"
#include "e2e_cdiff/ros/conversions.h"
#include "e2e_cdiff/scenario/closed_loop.h"

namespace cdiff::ros {
namespace {

std::unique_ptr<scenario::SessionSetup> setupOf(const msgs::SessionInfo& info) {
  return std::make_unique<scenario::SessionSetup>(optionsFromMsg(info), importFromMsg(info),
                                                  routeFromMsg(info));
}

std::unique_ptr<planning::Planner> makePlanner(const std::string& name,
                                               const scenario::SessionSetup& setup) {
  return planning::makePlanner(name, setup.options().plannerOptions(), setup.planningContext());
}

void warnOf(const ActionOrigin& origin) {
  if (!origin.fault.empty()) ROS_WARN("%s: %s", origin.planner.c_str(), origin.fault.c_str());
}

}  // namespace

void EgoPlannerRos::begin(const msgs::SessionInfo& info) {
  setup_ = setupOf(info);
  planner_ = makePlanner(setup_->options().ego_planner, *setup_);
  controls_ = advertise<msgs::ControlAction>(kEgoControlTopic);
  listen<nav_msgs::Path>(kEgoRouteTopic, [this](const nav_msgs::PathConstPtr& path) {
    if (route_.empty() && !path->poses.empty())
      route_ = map::matchRoute(setup_->network(), fromMsg(*path));
  });
}

std::string EgoPlannerRos::waitingFor() const {
  return route_.empty() ? "no ego route has come yet" : "";
}

bool EgoPlannerRos::handle(const Snapshot& message, bool) {
  if (!message->decision_tick) return true;
  const traffic::TrafficSnapshot snapshot = fromMsg(*message);
  const auto tasks = scenario::egoTasks(snapshot, route_, setup_->options().target_speed);
  if (tasks.empty()) return true;
  ActionOrigin origin{"ego:" + setup_->options().ego_planner, 0.0, {}};
  const auto actions =
      scenario::planTimed(*planner_, snapshot, tasks, origin.latency_ms, origin.fault);
  controls_.publish(
      boost::make_shared<const msgs::ControlAction>(toMsg(actions.front(), snapshot, origin)));
  warnOf(origin);
  return true;
}

void CbvPlannerRos::begin(const msgs::SessionInfo& info) {
  setup_ = setupOf(info);
  planner_ = makePlanner(setup_->options().cbv_planner, *setup_);
  for (int slot = 0; slot < graph().max_cbv; ++slot) {
    controls_.push_back(advertise<msgs::ControlAction>(cbvControlTopic(slot)));
    rollouts_.push_back(advertise<msgs::Rollout>(cbvRolloutTopic(slot)));
  }
  listen<msgs::CbvSelection>(kSelectionTopic,
                             [this](const msgs::CbvSelection::ConstPtr& selection) {
                               selections_.emplace(selection->tick, selection);
                             });
}

bool CbvPlannerRos::handle(const Snapshot& message, bool superseded) {
  if (!message->decision_tick) return true;
  const auto found = selections_.find(message->tick);
  if (found == selections_.end()) return superseded;
  plan(fromMsg(*message), *found->second);
  selections_.erase(selections_.begin(), selections_.upper_bound(message->tick));
  return true;
}

void CbvPlannerRos::plan(const traffic::TrafficSnapshot& snapshot,
                         const msgs::CbvSelection& message) {
  const cbv::CbvSelection selection = fromMsg(message, setup_->network());
  const auto tasks = scenario::cbvTasks(snapshot, selection, setup_->options().target_speed);
  if (tasks.empty()) return;
  ActionOrigin origin{"cbv:" + setup_->options().cbv_planner, 0.0, {}};
  for (const planning::PlannedAction& action :
       scenario::planTimed(*planner_, snapshot, tasks, origin.latency_ms, origin.fault)) {
    const auto slot = static_cast<std::size_t>(action.slot);
    rollouts_.at(slot).publish(
        boost::make_shared<const msgs::Rollout>(toRolloutMsg(action, snapshot)));
    controls_.at(slot).publish(
        boost::make_shared<const msgs::ControlAction>(toMsg(action, snapshot, origin)));
  }
  warnOf(origin);
}

}  // namespace cdiff::ros
