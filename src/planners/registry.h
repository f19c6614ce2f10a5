// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "e2e_cdiff/planning/planner_descriptor.h"

namespace cdiff::planners {

// The table of planners, for ego and CBVs alike: those of this package (the list in
// src/planners/CMakeLists.txt) and those that plug-ins add.

/// Adds a planner to the table; `source` names who does ("library /x/libmine.so"). Throws
/// InputError naming `source` for a name that is taken or not snake_case, no role, no options or
/// constructor, and a camera that its rig does not have.
void registerPlanner(planning::PlannerDescriptor descriptor, const std::string& source);

/// nullptr for an unknown name. "NAME+NAME..." are several planners of CBVs by slot
/// (planner_by_slot.h).
const planning::PlannerDescriptor* findPlanner(const std::string& name);
/// All planners, sorted by name.
std::vector<const planning::PlannerDescriptor*> registeredPlanners();
/// Who registered a planner; "" for an unknown name.
std::string sourceOf(const std::string& name);

/// Throws InputError naming the nearest known planner for an unknown name.
std::unique_ptr<planning::Planner> makePlanner(const std::string& name,
                                               const planning::PlannerParts& parts);

/// The default options of every planner.
planning::PlannerOptionsTable defaultOptions();

/// Names that makePlanner knows, sorted.
std::vector<std::string> plannerNames();
/// Names of the planners that follow guidance objectives, sorted.
std::vector<std::string> guidedPlannerNames();
/// Whether a planner of this name follows guidance objectives; false for unknown names.
bool canBeGuided(const std::string& name);
/// Whether a planner of this name needs images; false for unknown names.
bool seesImages(const std::string& name);
/// The preset of the cameras that a planner's vehicles have unless the scenario says otherwise;
/// "front" for unknown names.
std::string rigOfPlanner(const std::string& name);
/// The cameras that a scenario gives to a role's vehicles.
struct RigChoice {
  std::string key;  ///< "ego_rig"
  const rendering::RigOptions& options;
  const rendering::CameraOptions& camera;
};
/// Throws InputError naming the planner's `key`, the camera and the rig's key where the vehicles of
/// the planner `name` lack a camera that it needs; unknown names need none.
void requireRig(const std::string& key, const std::string& name, const RigChoice& rig);
/// Name of the planner with this title; "" when there is none.
std::string plannerTitled(const std::string& title);

/// Planners of a scenario that does not name any.
extern const char* const kDefaultEgoPlanner;
extern const char* const kDefaultCbvPlanner;

/// The planners of this package.
std::vector<planning::PlannerDescriptor> packagePlanners();

}  // namespace cdiff::planners
