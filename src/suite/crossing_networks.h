// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "suite/network_generator.h"

namespace cdiff::suite {

// Networks whose roads cross: one crossing or T junction, and a district of several.

RoadPlan drawCrossing(const NetworkSpec& spec, Draws& draws);

RoadPlan drawDistrict(const NetworkSpec& spec, Draws& draws);

}  // namespace cdiff::suite
