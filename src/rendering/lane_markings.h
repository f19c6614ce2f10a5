// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The markings of a network's lanes: solid white lines at the road's edges, dashed white ones
/// between lanes of one direction, solid yellow ones beside lanes of the other direction.
#pragma once

#include <vector>

#include "rendering/road_scene.h"

namespace cdiff::rendering {

/// What a piece of a lane's outer border is: the road's edge, the centre line to the lanes of the
/// other direction, or nothing (it lies on another lane).
enum class Border { kEdge, kCenter, kNone };

/// `point` lies on the border, `heading` is the lane's there.
Border borderAt(const map::RoadNetwork& network, const map::Lane& lane,
                const Eigen::Vector3d& point, double heading);

std::vector<Marking> laneMarkings(const map::RoadNetwork& network);

}  // namespace cdiff::rendering
