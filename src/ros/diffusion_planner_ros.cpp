// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/diffusion_planner_ros.h"

#include "ros/session_parts.h"
#include "ros/tick_answers.h"

namespace cdiff::ros {

void DiffusionPlannerRos::begin(const msgs::SessionInfo& info) {
  CbvPlannerRos::begin(info);
  images_ = ImageInbox(setup().options().camera, setup().options().simulation_step);
  statistics_ = PlannerStatistics(setup().options().decision_period);
  guidance_ = advertise<msgs::GuidanceReport>(kGuidanceTopic);
  for (int slot = 0; slot < graph().max_cbv; ++slot) {
    listen<sensor_msgs::Image>(imageTopic(slot),
                               [this, slot](const auto& image) { images_.add(slot, image); });
  }
  diagnostics_ = std::make_unique<diagnostic_updater::Updater>();
  diagnostics_->setHardwareID(setup().options().name);
  diagnostics_->add("planner", &statistics_, &PlannerStatistics::diagnose);
}

bool DiffusionPlannerRos::complete(const msgs::TrafficSnapshot& snapshot,
                                   const msgs::CbvSelection& selection) const {
  for (const msgs::CbvAssignment& assignment : selection.assignments) {
    if (!contains(snapshot, assignment.vehicle_id)) continue;
    if (!images_.find(assignment.slot, snapshot.tick)) return false;
  }
  return true;
}

std::vector<planning::PlannedAction> DiffusionPlannerRos::decide(
    const traffic::TrafficSnapshot& snapshot, const std::vector<planning::PlanningTask>& tasks,
    ActionOrigin& origin) {
  SeeingDecision decision = planSeeing(planner(), snapshot, tasks, images_);
  origin.latency_ms = decision.latency_ms;
  origin.fault = decision.fault;
  statistics_.observe(decision);
  publishGuidance(snapshot, decision);
  images_.forgetBefore(snapshot.tick + 1);
  diagnostics_->update();
  return std::move(decision.actions);
}

void DiffusionPlannerRos::publishGuidance(const traffic::TrafficSnapshot& snapshot,
                                          const SeeingDecision& decision) {
  msgs::GuidanceReport message = toGuidanceMsg(decision.actions, snapshot);
  message.planner_latency_ms = decision.latency_ms;
  message.image_age = decision.image_age;
  guidance_.publish(boost::make_shared<const msgs::GuidanceReport>(message));
}

}  // namespace cdiff::ros
