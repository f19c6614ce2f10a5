// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/planning/planner_factory.h"

#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/text.h"
#include "e2e_cdiff/planning/pdm_lite.h"

namespace cdiff::planning {
namespace {

using Constructor = std::unique_ptr<Planner> (*)(const PlannerOptions&, const PlanningContext&);

struct Entry {
  const char* name;
  Constructor make;
};

std::unique_ptr<Planner> makePdmLite(const PlannerOptions& options,
                                     const PlanningContext& context) {
  return std::make_unique<PdmLite>(options.pdm_lite, options.vehicle, context);
}

/// The table, sorted by name: a new planner is one more line.
constexpr Entry kPlanners[] = {
    {"pdm_lite", &makePdmLite},
};

}  // namespace

std::unique_ptr<Planner> makePlanner(const std::string& name, const PlannerOptions& options,
                                     const PlanningContext& context) {
  for (const Entry& entry : kPlanners) {
    if (name == entry.name) return entry.make(options, context);
  }
  if (name == "external") {
    throw core::InputError(
        "planner 'external' is a node of the user's own: it needs the node graph "
        "(session.launch), not a planner in this process");
  }
  throw core::InputError("unknown planner '" + name + "'; the nearest known planner is '" +
                         core::nearestName(name, plannerNames()) + "'");
}

std::vector<std::string> plannerNames() {
  std::vector<std::string> names;
  for (const Entry& entry : kPlanners) names.emplace_back(entry.name);
  return names;
}

}  // namespace cdiff::planning
