// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The table from planner name to constructor, for ego and CBVs alike.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "e2e_cdiff/dynamics/bicycle_model.h"
#include "e2e_cdiff/planning/pdm_lite_options.h"
#include "e2e_cdiff/planning/planner.h"

namespace cdiff::planning {

/// Options of all planners; each takes its own.
struct PlannerOptions {
  PdmLiteOptions pdm_lite;
  dynamics::BicycleModelOptions vehicle;
};

/// Throws InputError naming the nearest known planner for an unknown name.
std::unique_ptr<Planner> makePlanner(const std::string& name, const PlannerOptions& options,
                                     const PlanningContext& context);

/// Names that makePlanner knows, sorted.
std::vector<std::string> plannerNames();

}  // namespace cdiff::planning
