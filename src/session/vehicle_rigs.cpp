// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "session/vehicle_rigs.h"

#include "planners/planner_by_slot.h"

namespace cdiff::session {

VehicleRigs::VehicleRigs(const ScenarioOptions& options) {
  rigs_ = {rendering::rigOf(options.ego_rig, options.camera,
                            planners::rigOfPlanner(options.ego_planner))};
  for (const std::string& planner : planners::planningMembers(options.cbv_planner)) {
    rigs_.push_back(
        rendering::rigOf(options.cbv_rig, options.camera, planners::rigOfPlanner(planner)));
  }
}

VehicleRigs VehicleRigs::front(const rendering::CameraOptions& camera) {
  VehicleRigs rigs;
  rigs.rigs_ = {rendering::frontRig(camera), rendering::frontRig(camera)};
  return rigs;
}

std::size_t VehicleRigs::indexOf(int slot) const {
  return slot == traffic::kEgoSlot ? 0 : 1 + static_cast<std::size_t>(slot) % (rigs_.size() - 1);
}

}  // namespace cdiff::session
