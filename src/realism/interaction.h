// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "realism/recording.h"

namespace cdiff::realism {

// Features of a vehicle among the others of its recording (SI units).

/// Beyond every histogram: no other vehicle is there [m].
inline constexpr double kNobody = 1e10;
/// Of time to collision [s].
inline constexpr double kLongestTime = 5.0;

/// Distance of two boxes [m]; negative where they overlap: by how much they must be moved apart.
/// That of the origin to the border of their Minkowski difference.
double signedDistance(const geometry::OrientedBox& first, const geometry::OrientedBox& second);

/// A vehicle as time to collision sees it.
struct MovingBox {
  geometry::OrientedBox box;
  double speed = 0.0;  ///< along its heading [m/s]
};

/// Gap along its heading to the nearest vehicle ahead of its front divided by the closing speed,
/// at most 5 s [s]. Ahead: headings differ by at most 75 degrees, 10 degrees where they overlap
/// laterally by less than 0.5 m; the lateral extents overlap.
double timeToCollision(const MovingBox& self, const std::vector<MovingBox>& others);

/// Features of one track of a recording at the steps from `begin` to `end`, without those of the
/// map (empty). `motions`: of all tracks. Steps without the track are NaN.
Course courseOf(const Recording& recording, const std::vector<Motion>& motions, std::size_t track,
                std::size_t begin, std::size_t end);

}  // namespace cdiff::realism
