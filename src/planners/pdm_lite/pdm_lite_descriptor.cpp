// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/planning/planner.h"
#include "planners/pdm_lite/pdm_lite.h"

namespace cdiff::planners {

planning::PlannerDescriptor pdmLiteDescriptor() {
  planning::PlannerDescriptor descriptor;
  descriptor.name = "pdm_lite";
  descriptor.title = "PDM-Lite";
  descriptor.help = "rules on the true positions of all vehicles, with IDM and forecast boxes.";
  descriptor.options = planning::makePlannerOptions<PdmLiteOptions>;
  descriptor.make = [](const planning::PlannerParts& parts) {
    return std::make_unique<PdmLite>(parts.options.of<PdmLiteOptions>(), parts.vehicle,
                                     parts.context);
  };
  return descriptor;
}

}  // namespace cdiff::planners
