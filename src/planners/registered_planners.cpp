// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The planners of this package: each is a folder with its descriptor, declared and listed here.
#include "planners/registry.h"

namespace cdiff::planners {

planning::PlannerDescriptor diffusionDescriptor();
planning::PlannerDescriptor pdmLiteDescriptor();
planning::PlannerDescriptor twoStagePidDescriptor();

const char* const kDefaultEgoPlanner = "pdm_lite";
const char* const kDefaultCbvPlanner = "diffusion";

std::vector<planning::PlannerDescriptor> packagePlanners() {
  return {diffusionDescriptor(), pdmLiteDescriptor(), twoStagePidDescriptor()};
}

}  // namespace cdiff::planners
