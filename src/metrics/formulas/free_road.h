// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "e2e_cdiff/geometry/shapes.h"
#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::metrics {

/// The part of a line between two arc lengths [m], swept by a width [m]: boxes of at most 2 m on
/// its chords (map frame). Nothing where `end` <= `begin`; both are clamped to the line.
std::vector<geometry::OrientedBox> stripAlong(const geometry::Polyline& line, double begin,
                                              double end, double width);

/// Whether a box shares a point with one of the boxes of a strip.
bool overlapsStrip(const geometry::OrientedBox& box,
                   const std::vector<geometry::OrientedBox>& strip);

/// Slower than this is standing [m/s].
inline constexpr double kStandingSpeed = 0.1;

/// Whether nothing keeps a standing vehicle from driving on along its route (map frame): over the
/// 10 m of the route before its front,
///  - no box of another vehicle on its level touches the strip of its width and 0.25 m to each
///    side,
///  - no stop line of a light that shows red, red-yellow or yellow lies in them, nor up to 1 m
///    behind its front,
///  - and, where they or the vehicle touch a junction, no other vehicle on its level that moves is
///    within 25 m of it: it may have to yield.
bool isRoadFree(const traffic::Vehicle& vehicle, const map::Route& route,
                const traffic::TrafficSnapshot& snapshot);

}  // namespace cdiff::metrics
