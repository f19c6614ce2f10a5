// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/markup.h"
#include "page/pictures/map_canvas.h"

namespace cdiff::page {

/// One thing that the ego's planner believes to see, as a path of a CSS class and an opacity.
struct PerceivedPath {
  std::string style;
  double opacity = 1.0;
  std::string data;
};
/// All of a frame: occupied cells (the later the fainter), lines of the road by kind, the likeliest
/// way and the box of each vehicle (opaque by score).
std::vector<PerceivedPath> perceivedPaths(const planning::Perception& perception,
                                          const MapCanvas& canvas);

/// Whether the ego's planner said what it believes to see.
bool showsPerception(const record::Timeline& timeline);

/// perceivedPaths of the last frame that has any; empty where the planner never says so.
core::Markup perceivedSvg(const record::Timeline& timeline, const MapCanvas& canvas);

}  // namespace cdiff::page
