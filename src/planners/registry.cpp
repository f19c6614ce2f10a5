// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/registry.h"

#include <algorithm>
#include <map>

#include "core/names.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::planners {
namespace {

using core::InputError;
using planning::PlannerDescriptor;

struct Registered {
  PlannerDescriptor descriptor;
  std::string source;
};

using Table = std::map<std::string, Registered>;

/// What is wrong with a descriptor; empty when nothing is.
std::string faultOf(const PlannerDescriptor& descriptor) {
  if (!core::isSnakeCase(descriptor.name) || descriptor.name == planning::kExternalPlanner)
    return "its name must be snake_case and other than 'external'";
  if (!descriptor.options) return "its descriptor has no options";
  if (!descriptor.make) return "its descriptor has no constructor";
  if (!descriptor.drives_ego && !descriptor.drives_cbv) return "it drives neither the ego nor CBVs";
  if (!descriptor.network != !descriptor.weights_sha256)
    return "its descriptor must have both 'network' and 'weights_sha256', or neither";
  for (const std::string& camera : descriptor.cameras) {
    if (camera != "front") return "it needs the camera '" + camera + "'; there is 'front' alone";
  }
  return "";
}

void add(Table& table, PlannerDescriptor descriptor, const std::string& source) {
  const std::string fault = faultOf(descriptor);
  if (!fault.empty()) throw InputError(source + ": planner '" + descriptor.name + "': " + fault);
  const auto found = table.find(descriptor.name);
  if (found != table.end()) {
    throw InputError(source + ": planner '" + descriptor.name + "' is already registered by " +
                     found->second.source + "; one of the two needs another name");
  }
  const std::string name = descriptor.name;
  table.emplace(name, Registered{std::move(descriptor), source});
}

Table& table() {
  static Table planners = [] {
    Table of_package;
    for (PlannerDescriptor& descriptor : packagePlanners())
      add(of_package, std::move(descriptor), "package e2e_cdiff");
    return of_package;
  }();
  return planners;
}

}  // namespace

void registerPlanner(PlannerDescriptor descriptor, const std::string& source) {
  add(table(), std::move(descriptor), source);
}

const PlannerDescriptor* findPlanner(const std::string& name) {
  const auto found = table().find(name);
  return found == table().end() ? nullptr : &found->second.descriptor;
}

std::vector<const PlannerDescriptor*> registeredPlanners() {
  std::vector<const PlannerDescriptor*> planners;
  for (const auto& [name, registered] : table()) planners.push_back(&registered.descriptor);
  return planners;
}

std::string sourceOf(const std::string& name) {
  const auto found = table().find(name);
  return found == table().end() ? "" : found->second.source;
}

std::unique_ptr<planning::Planner> makePlanner(const std::string& name,
                                               const planning::PlannerParts& parts) {
  if (const PlannerDescriptor* descriptor = findPlanner(name)) return descriptor->make(parts);
  if (name == planning::kExternalPlanner) {
    throw InputError(
        "planner 'external' is a node of the user's own: it needs the node graph "
        "(session.launch), not a planner in this process");
  }
  throw InputError("unknown planner '" + name + "'; the nearest known planner is '" +
                   core::nearestName(name, plannerNames()) + "'");
}

planning::PlannerOptionsTable defaultOptions() {
  std::vector<planning::PlannerOptionsTable::Entry> entries;
  for (const PlannerDescriptor* descriptor : registeredPlanners()) {
    entries.push_back({descriptor->name, "Planner " + descriptor->name + ": " + descriptor->help,
                       descriptor->options()});
  }
  return planning::PlannerOptionsTable(std::move(entries));
}

std::vector<std::string> plannerNames() {
  std::vector<std::string> names;
  for (const PlannerDescriptor* descriptor : registeredPlanners())
    names.push_back(descriptor->name);
  return names;
}

std::vector<std::string> guidedPlannerNames() {
  std::vector<std::string> names = plannerNames();
  names.erase(std::remove_if(names.begin(), names.end(),
                             [](const std::string& name) { return !canBeGuided(name); }),
              names.end());
  return names;
}

bool canBeGuided(const std::string& name) {
  const PlannerDescriptor* descriptor = findPlanner(name);
  return descriptor != nullptr && descriptor->guided;
}

bool seesImages(const std::string& name) {
  const PlannerDescriptor* descriptor = findPlanner(name);
  return descriptor != nullptr && descriptor->sees();
}

std::string plannerTitled(const std::string& title) {
  for (const PlannerDescriptor* descriptor : registeredPlanners()) {
    if (descriptor->title == title) return descriptor->name;
  }
  return "";
}

}  // namespace cdiff::planners
