// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "guidance/objective_registry.h"

#include <algorithm>
#include <deque>

#include "core/names.h"
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

using core::InputError;

struct Registered {
  ObjectiveDescriptor descriptor;
  std::string source;
};

template <class Kind>
std::unique_ptr<Objective> make() {
  return std::make_unique<Kind>();
}

/// The objectives of this package, in the order of profiles and reports: a new one is one more row.
std::deque<Registered> objectivesOfPackage() {
  const std::string source = "package e2e_cdiff";
  return {
      {{"speed", "Drives at the target speed.", make<SpeedObjective>}, source},
      {{"drivable_area", "Stays inside the drivable area.", make<DrivableAreaObjective>}, source},
      {{"collision_avoidance", "Keeps away from the other vehicle.",
        make<CollisionAvoidanceObjective>},
       source},
      {{"collision_seeking", "Approaches the other vehicle once it is near.",
        make<CollisionSeekingObjective>},
       source},
      {{"traffic_avoidance", "Keeps away from the vehicles around but the other one.",
        make<TrafficAvoidanceObjective>},
       source},
      {{"route", "Stays near the route.", make<RouteObjective>}, source},
      {{"comfort", "Moves the pedals and turns gently.", make<ComfortObjective>}, source},
  };
}

/// A deque: what it holds stays where it is when a plug-in adds to it.
std::deque<Registered>& table() {
  static std::deque<Registered> objectives = objectivesOfPackage();
  return objectives;
}

const Registered* find(const std::string& name) {
  const auto found = std::find_if(table().begin(), table().end(), [&](const Registered& entry) {
    return entry.descriptor.name == name;
  });
  return found == table().end() ? nullptr : &*found;
}

const ObjectiveDescriptor& descriptorOf(const std::string& name) {
  if (const Registered* found = find(name)) return found->descriptor;
  throw InputError("unknown guidance objective '" + name + "'; the nearest known objective is '" +
                   core::nearestName(name, objectiveNames()) + "'");
}

}  // namespace

void registerObjective(ObjectiveDescriptor descriptor, const std::string& source) {
  const std::string what = source + ": guidance objective '" + descriptor.name + "'";
  if (!core::isSnakeCase(descriptor.name)) throw InputError(what + ": its name must be snake_case");
  if (!descriptor.make || descriptor.help.empty())
    throw InputError(what + ": its descriptor lacks a constructor or a sentence of help");
  if (const Registered* other = find(descriptor.name)) {
    throw InputError(what + " is already registered by " + other->source +
                     "; one of the two needs another name");
  }
  table().push_back({std::move(descriptor), source});
}

std::vector<std::string> objectiveNames() {
  std::vector<std::string> names;
  for (const Registered& entry : table()) names.push_back(entry.descriptor.name);
  return names;
}

const char* objectiveText(const std::string& name) { return descriptorOf(name).help.c_str(); }

std::unique_ptr<Objective> makeObjective(const std::string& name) {
  return descriptorOf(name).make();
}

}  // namespace cdiff::guidance
