// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "suite/network_generator.h"

namespace cdiff::suite {

// Networks in which traffic merges: roundabouts and on-ramps.

RoadPlan drawRoundabout(const NetworkSpec& spec, Draws& draws);
RoadPlan drawMerge(const NetworkSpec& spec, Draws& draws);

}  // namespace cdiff::suite
