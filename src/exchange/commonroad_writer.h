// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <string>

#include "exchange/recorded_scene.h"

namespace cdiff::exchange {

/// A CommonRoad file and what it lacks.
struct CommonRoadFile {
  std::string text;
  std::size_t left_out = 0;  ///< vehicles that appear after the start, which the format cannot hold
};

/// A CommonRoad 2020a file of a recorded scene: the lanes for cars as lanelets, the other vehicles
/// as dynamic obstacles from the scene's start on, the ego as a planning problem from its first to
/// its last place. Positions are centers of boxes in the map frame, SI units; a time is a number of
/// ticks. The same scene gives the same bytes. Throws InputError when the ego is not there at the
/// scene's start, or only then.
CommonRoadFile commonRoadFile(const RecordedScene& scene);

}  // namespace cdiff::exchange
