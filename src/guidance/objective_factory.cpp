// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "guidance/objective_factory.h"

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "guidance/collision_avoidance_objective.h"
#include "guidance/collision_seeking_objective.h"
#include "guidance/comfort_objective.h"
#include "guidance/drivable_area_objective.h"
#include "guidance/route_objective.h"
#include "guidance/speed_objective.h"
#include "guidance/traffic_avoidance_objective.h"

namespace cdiff::guidance {
namespace {

struct Entry {
  const char* name;
  std::unique_ptr<Objective> (*make)();
  const char* text;
};

template <class Kind>
std::unique_ptr<Objective> make() {
  return std::make_unique<Kind>();
}

/// The table: a new objective is one more line.
constexpr Entry kObjectives[] = {
    {"speed", &make<SpeedObjective>, "Drives at the target speed."},
    {"drivable_area", &make<DrivableAreaObjective>, "Stays inside the drivable area."},
    {"collision_avoidance", &make<CollisionAvoidanceObjective>,
     "Keeps away from the other vehicle."},
    {"collision_seeking", &make<CollisionSeekingObjective>,
     "Approaches the other vehicle once it is near."},
    {"traffic_avoidance", &make<TrafficAvoidanceObjective>,
     "Keeps away from the vehicles around but the other one."},
    {"route", &make<RouteObjective>, "Stays near the route."},
    {"comfort", &make<ComfortObjective>, "Moves the pedals and turns gently."},
};

const Entry* findEntry(const std::string& name) {
  for (const Entry& entry : kObjectives) {
    if (name == entry.name) return &entry;
  }
  return nullptr;
}

const Entry& entryOf(const std::string& name) {
  if (const Entry* entry = findEntry(name)) return *entry;
  throw core::InputError("unknown guidance objective '" + name +
                         "'; the nearest known objective is '" +
                         core::nearestName(name, objectiveNames()) + "'");
}

}  // namespace

std::vector<std::string> objectiveNames() {
  std::vector<std::string> names;
  for (const Entry& entry : kObjectives) names.emplace_back(entry.name);
  return names;
}

const char* objectiveText(const std::string& name) { return entryOf(name).text; }

std::unique_ptr<Objective> makeObjective(const std::string& name) { return entryOf(name).make(); }

}  // namespace cdiff::guidance
