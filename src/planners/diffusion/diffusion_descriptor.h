// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>

#include "e2e_cdiff/planning/planner_descriptor.h"
#include "planners/diffusion/diffusion_planner.h"

namespace cdiff::planners {

// The diffusion planner in the table of planners, and for planners that plan with it.

planning::PlannerDescriptor diffusionDescriptor();

/// Throws InputError if the camera has not the size of the model's images.
std::unique_ptr<DiffusionPlanner> makeDiffusionPlanner(const planning::PlannerParts& parts);

}  // namespace cdiff::planners
