// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "suite/network_generator.h"

namespace cdiff::suite {

// Networks whose roads cross: one crossing or T junction, a district of several, and a regular
// grid.

RoadPlan drawCrossing(const NetworkSpec& spec, Draws& draws);

RoadPlan drawDistrict(const NetworkSpec& spec, Draws& draws);

/// `count` x `count` crossings, `spacing` meters apart (at most 26): columns A, B, ... from west to
/// east, rows 0, 1, ... from south to north; the edge from A0 to B0 is "A0B0". Streets along x have
/// priority. Nothing is drawn.
RoadPlan gridPlan(const std::string& name, int count, double spacing);

}  // namespace cdiff::suite
