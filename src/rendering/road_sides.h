// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What stands beside roads that lie higher than their surroundings: grass slopes down to the
/// lowest road near, or the side of a bridge's deck where a lower road is in the way.
#pragma once

#include <vector>

#include "rendering/road_scene.h"

namespace cdiff::rendering {

std::vector<Surface> roadSides(const map::RoadNetwork& network);

}  // namespace cdiff::rendering
