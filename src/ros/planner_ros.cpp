// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/planner_ros.h"

#include "e2e_cdiff/core/exceptions.h"
#include "ros/markers.h"
#include "ros/message_checks.h"
#include "ros/session_parts.h"
#include "session/closed_loop.h"

namespace cdiff::ros {
namespace {

void warnOf(const std::vector<planning::PlannedAction>& actions, const ActionOrigin& origin) {
  if (!origin.fault.empty()) ROS_WARN("%s: %s", origin.planner.c_str(), origin.fault.c_str());
  for (const planning::PlannedAction& action : actions) {
    if (action.fault.empty()) continue;
    ROS_WARN("%s: %s: %s", origin.planner.c_str(), action.vehicle_id.c_str(), action.fault.c_str());
  }
}

/// The traffic simulator goes by the planner's name when it says who takes part.
void checkSight(const planning::Planner& planner, bool session_expects, const std::string& name) {
  if (planner.needsImages() == session_expects) return;
  throw core::InputError("planner '" + name + "' " +
                         (session_expects ? "takes no images, but the session gives it some"
                                          : "needs images, which the session does not give it"));
}

}  // namespace

void EgoPlannerRos::begin(const msgs::SessionInfo& info) {
  setup_ = setupOf(info);
  planner_ = setup_->makeEgoPlanner();
  checkSight(*planner_, graph().ego_sees, setup_->options().ego_planner);
  images_ = ImageInbox(setup_->options().camera, setup_->options().simulation_step);
  controls_ = advertise<msgs::ControlAction>(kEgoControlTopic);
  listen<nav_msgs::Path>(kEgoRouteTopic, [this](const nav_msgs::PathConstPtr& path) {
    if (route_.empty() && !path->poses.empty())
      route_ = map::matchRoute(setup_->network(), fromMsg(*path));
  });
  if (!graph().ego_sees) return;
  listen<sensor_msgs::Image>(imageTopic(kEgoSlot),
                             [this](const auto& image) { images_.add(kEgoSlot, image); });
}

std::string EgoPlannerRos::waitingFor() const {
  return route_.empty() ? "no ego route has come yet" : "";
}

bool EgoPlannerRos::ready(const msgs::TrafficSnapshot& snapshot) const {
  return !graph().ego_sees || images_.find(kEgoSlot, snapshot.tick);
}

bool EgoPlannerRos::handle(const Snapshot& message, bool superseded) {
  if (!message->decision_tick) return true;
  const bool blind = !ready(*message);
  const traffic::TrafficSnapshot snapshot = fromMsg(*message);
  const auto tasks = session::egoTasks(snapshot, route_, setup_->options().target_speed);
  if (tasks.empty()) return true;
  if (blind && !superseded) return false;
  ActionOrigin origin{"ego:" + setup_->options().ego_planner, 0.0, {}};
  const auto actions = decide(snapshot, tasks, origin);
  controls_.publish(
      boost::make_shared<const msgs::ControlAction>(toMsg(actions.front(), snapshot, origin)));
  warnOf(actions, origin);
  images_.forgetBefore(message->tick);
  return true;
}

std::vector<planning::PlannedAction> EgoPlannerRos::decide(
    const traffic::TrafficSnapshot& snapshot, const std::vector<planning::PlanningTask>& tasks,
    ActionOrigin& origin) {
  if (!graph().ego_sees)
    return session::planTimed(*planner_, snapshot, tasks, origin.latency_ms, origin.fault);
  SeeingDecision decision = planSeeing(*planner_, snapshot, tasks, images_);
  origin.latency_ms = decision.latency_ms;
  origin.fault = decision.fault;
  return std::move(decision.actions);
}

void CbvPlannerRos::begin(const msgs::SessionInfo& info) {
  setup_ = setupOf(info);
  planner_ = setup_->makeCbvPlanner();
  checkSight(*planner_, graph().cbvsSee(), setup_->options().cbv_planner);
  for (int slot = 0; slot < graph().max_cbv; ++slot) {
    controls_.push_back(advertise<msgs::ControlAction>(cbvControlTopic(slot)));
    rollouts_.push_back(advertise<msgs::Rollout>(cbvRolloutTopic(slot)));
  }
  markers_ = advertise<visualization_msgs::MarkerArray>(kRolloutMarkersTopic);
  listen<msgs::CbvSelection>(kSelectionTopic, [this](const auto& selection) {
    const std::string wrong = unusable(*selection, graph().max_cbv);
    if (wrong.empty()) selections_.emplace(selection->tick, selection);
    return wrong;
  });
}

bool CbvPlannerRos::ready(const msgs::TrafficSnapshot& snapshot) const {
  const auto found = selections_.find(snapshot.tick);
  return found != selections_.end() && complete(snapshot, *found->second);
}

bool CbvPlannerRos::handle(const Snapshot& message, bool superseded) {
  if (!message->decision_tick) return true;
  const auto found = selections_.find(message->tick);
  if (found == selections_.end()) return superseded;
  if (!superseded && !complete(*message, *found->second)) return false;
  plan(fromMsg(*message), *found->second);
  selections_.erase(selections_.begin(), selections_.upper_bound(message->tick));
  return true;
}

void CbvPlannerRos::plan(const traffic::TrafficSnapshot& snapshot,
                         const msgs::CbvSelection& message) {
  const cbv::CbvSelection selection = fromMsg(message, setup_->network());
  const auto tasks = session::cbvTasks(snapshot, selection, setup_->options().target_speed);
  if (tasks.empty()) return;
  ActionOrigin origin{"cbv:" + setup_->options().cbv_planner, 0.0, {}};
  const std::vector<planning::PlannedAction> actions = decide(snapshot, tasks, origin);
  publish(snapshot, actions, origin);
  warnOf(actions, origin);
}

std::vector<planning::PlannedAction> CbvPlannerRos::decide(
    const traffic::TrafficSnapshot& snapshot, const std::vector<planning::PlanningTask>& tasks,
    ActionOrigin& origin) {
  return session::planTimed(*planner_, snapshot, tasks, origin.latency_ms, origin.fault);
}

void CbvPlannerRos::publish(const traffic::TrafficSnapshot& snapshot,
                            const std::vector<planning::PlannedAction>& actions,
                            const ActionOrigin& origin) {
  for (const planning::PlannedAction& action : actions) {
    const auto slot = static_cast<std::size_t>(action.slot);
    rollouts_.at(slot).publish(
        boost::make_shared<const msgs::Rollout>(toRolloutMsg(action, snapshot)));
    controls_.at(slot).publish(
        boost::make_shared<const msgs::ControlAction>(toMsg(action, snapshot, origin)));
  }
  if (markers_.getNumSubscribers() > 0) markers_.publish(rolloutMarkers(actions, snapshot.time));
}

}  // namespace cdiff::ros
