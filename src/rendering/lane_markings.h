// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The markings of a network's lanes: solid white lines at the road's edges, dashed white ones
/// between lanes of one direction, solid yellow ones beside lanes of the other direction.
#pragma once

#include <vector>

#include "road_scene.h"

namespace cdiff::rendering {

std::vector<Marking> laneMarkings(const map::RoadNetwork& network);

}  // namespace cdiff::rendering
