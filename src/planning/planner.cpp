// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/planning/planner.h"

#include <algorithm>

namespace cdiff::planning {

const traffic::CameraImage* CameraViews::find(const std::string& camera) const {
  if (rig == nullptr) return nullptr;
  for (std::size_t i = 0; i < std::min(images.size(), rig->cameras.size()); ++i) {
    if (rig->cameras[i].name == camera) return images[i];
  }
  return nullptr;
}

std::string CameraViews::missing() const {
  if (rig == nullptr) return "";
  for (const rendering::RigCamera& camera : rig->cameras) {
    if (find(camera.name) == nullptr) return camera.name;
  }
  return "";
}

PlannedAction failSafeAction(const PlanningTask& task, const std::string& reason) {
  PlannedAction action{task.slot, task.vehicle->id, traffic::ControlAction::failSafe(), {}};
  if (!reason.empty())
    action.fault = "vehicle '" + action.vehicle_id + "': " + reason + "; full braking instead";
  return action;
}

PlannerOptionsTable::PlannerOptionsTable(const PlannerOptionsTable& other) {
  for (const Entry& entry : other.entries_)
    entries_.push_back({entry.name, entry.help, entry.options->clone()});
}

PlannerOptionsTable& PlannerOptionsTable::operator=(const PlannerOptionsTable& other) {
  if (this != &other) *this = PlannerOptionsTable(other);
  return *this;
}

void PlannerOptionsTable::describe(core::OptionsVisitor& visitor) {
  for (Entry& entry : entries_)
    visitor.group({entry.name.c_str(), "", entry.help.c_str()}, *entry.options);
}

void PlannerOptionsTable::validate() const {
  for (const Entry& entry : entries_) entry.options->validate();
}

}  // namespace cdiff::planning
