// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>

#include "core/markup.h"
#include "page/pictures/map_canvas.h"

namespace cdiff::page {

/// Whether any planner of the session said what it looked at.
bool showsAttention(const record::Timeline& timeline);

/// Lines from drivers to the vehicles that they look at in the last frame, as thick and dark as
/// they do; empty where no planner of the session says so.
core::Markup attentionSvg(const record::Timeline& timeline, const MapCanvas& canvas);

}  // namespace cdiff::page
