// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>

#include "e2e_cdiff/geometry/shapes.h"

namespace cdiff::metrics {

// The time [s] between two moving boxes being at one place, exact for boxes that keep velocity and
// heading.

/// A box that moves from one tick to the next, map frame.
struct SweptBox {
  geometry::OrientedBox box;                         ///< where it starts
  Eigen::Vector2d offset = Eigen::Vector2d::Zero();  ///< to where it ends [m]
  double elevation = 0.0;                            ///< [m]
  double begin = 0.0;                                ///< [s]
  double duration = 0.0;                             ///< [s]
};

/// Shortest and longest time from the first box being at a place to the second being there [s],
/// negative when the second was there before; nullopt when they share no place.
struct TimeRange {
  double shortest = 0.0;
  double longest = 0.0;
};
std::optional<TimeRange> timesBetween(const SweptBox& first, const SweptBox& second);

/// Whether circles around both paths keep clear of each other.
bool farApart(const SweptBox& first, const SweptBox& second);

}  // namespace cdiff::metrics
