// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "diffusion/network/architecture.h"
#include "e2e_cdiff/geometry/shapes.h"

namespace cdiff::diffusion {

// Route tokens: points of the route ahead, every `route_spacing` meters from the vehicle's place
// on it (the first one `route_spacing` ahead), as (x, y) in the vehicle's body frame divided by 20
// m; beyond its end the route goes straight on.

/// What a token of 1 stands for [m].
inline constexpr double kRouteTokenScale = 20.0;

/// [route_points, 2] row-major.
std::vector<float> routeTokens(const Architecture& architecture, const geometry::Polyline& path,
                               double arc_length, const geometry::Pose2d& pose);

}  // namespace cdiff::diffusion
