// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "e2e_cdiff/geometry/shapes.h"

namespace cdiff::metrics {

/// The part of a line between two arc lengths [m], swept by a width [m]: boxes of at most 2 m on
/// its chords (map frame). Nothing where `end` <= `begin`; both are clamped to the line.
std::vector<geometry::OrientedBox> stripAlong(const geometry::Polyline& line, double begin,
                                              double end, double width);

/// Whether a box shares a point with one of the boxes of a strip.
bool overlapsStrip(const geometry::OrientedBox& box,
                   const std::vector<geometry::OrientedBox>& strip);

}  // namespace cdiff::metrics
