// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <vector>

#include "storyboard/places.h"
#include "storyboard/scenario.h"

namespace cdiff::storyboard {

// Curves of trajectories as points that lie close together (map frame [m], [rad]).

/// Places on a clothoid from its start on, at most half a meter apart; the last one is its end. The
/// elevation stays that of the start.
std::vector<MapPose> placesAlong(const Clothoid& curve, const MapPose& start);

/// x, y, z [m] and time [s].
using TimedPoint = Eigen::Vector4d;

/// Points on a spline with these control points, from its begin to its end. The spline fits to the
/// control points as the reader requires it.
std::vector<TimedPoint> pointsAlong(const Spline& spline, const std::vector<TimedPoint>& controls);

}  // namespace cdiff::storyboard
