// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/conversions.h"

namespace cdiff::ros {
namespace {

msgs::ObjectiveReport toMsg(const guidance::ObjectiveReport& report) {
  msgs::ObjectiveReport message;
  message.name = report.name;
  message.weight = report.weight;
  message.value = report.value;
  message.gradient_norm = report.gradient_norm;
  message.capped_share = report.capped_share;
  message.dropped = report.dropped;
  return message;
}

msgs::VehicleGuidance toGuidanceMsg(const planning::PlannedAction& action) {
  msgs::VehicleGuidance message;
  message.slot = action.slot;
  message.vehicle_id = action.vehicle_id;
  for (const guidance::ObjectiveReport& report : action.guidance.objectives)
    message.objectives.push_back(toMsg(report));
  message.candidates = action.guidance.candidates;
  message.chosen = action.guidance.chosen;
  message.trust_region_share = action.guidance.trust_region_share;
  message.state_mismatch = action.state_mismatch;
  message.fault = action.fault;
  return message;
}

}  // namespace

msgs::GuidanceReport toGuidanceMsg(const std::vector<planning::PlannedAction>& actions,
                                   const traffic::TrafficSnapshot& snapshot) {
  msgs::GuidanceReport message;
  message.header.stamp = toStamp(snapshot.time);
  message.header.frame_id = kMapFrame;
  message.tick = snapshot.tick;
  for (const planning::PlannedAction& action : actions)
    message.vehicles.push_back(toGuidanceMsg(action));
  return message;
}

guidance::GuidanceReport fromMsg(const msgs::VehicleGuidance& message) {
  guidance::GuidanceReport report;
  for (const msgs::ObjectiveReport& objective : message.objectives) {
    report.objectives.push_back({objective.name, objective.weight, objective.value,
                                 objective.gradient_norm, objective.capped_share,
                                 objective.dropped});
  }
  report.candidates = message.candidates;
  report.chosen = message.chosen;
  report.trust_region_share = message.trust_region_share;
  return report;
}

}  // namespace cdiff::ros
