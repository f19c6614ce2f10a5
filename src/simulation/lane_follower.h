// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Where on SUMO's lanes a vehicle that we drive belongs, and the way from
/// where SUMO has it to there [m along the lanes].
#pragma once

#include <optional>
#include <vector>

#include "simulation/driven_way.h"

namespace cdiff::simulation {

/// A place on a lane, of a front bumper.
struct LanePlace {
  map::LaneIndex lane = map::kNoLane;
  double arc_length = 0.0;  ///< along the lane's centre line [m]
};

/// The place next to which the front bumper is, and how far it is from `from`.
struct LaneTarget {
  LanePlace place;
  std::optional<double> ahead;  ///< driven length from `from`; absent where that
                                ///< is not on the way there [m]
};

/// The nearest place on a lane of `way` (edges in driving order) whose
/// direction is the vehicle's. The lanes that `from` leads to are preferred to
/// others that are nearer by little, so that lanes that overlap do not make the
/// target jump. nullopt when there is none.
std::optional<LaneTarget> laneTarget(const EdgeGraph& graph, const FrontPlace& front,
                                     double heading, const std::vector<int>& way,
                                     const LanePlace& from);

}  // namespace cdiff::simulation
