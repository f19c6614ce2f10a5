// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/planning/planner.h"

namespace cdiff::planning {

PlannedAction failSafeAction(const PlanningTask& task, const std::string& reason) {
  PlannedAction action{task.slot, task.vehicle->id, traffic::ControlAction::failSafe(), {}};
  if (!reason.empty())
    action.fault = "vehicle '" + action.vehicle_id + "': " + reason + "; full braking instead";
  return action;
}

}  // namespace cdiff::planning
