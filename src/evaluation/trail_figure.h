// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <vector>

#include "evaluation/paper/paper_figures.h"
#include "evaluation/trail_scene.h"

namespace cdiff::evaluation {

/// "trails" or "ego_trails": a panel for each planner of that scene with road, trails, contacts and
/// what became of it; none where there is no such scene.
std::optional<Figure> trailFigure(const std::vector<BatchRun>& runs, TrailsOf who);

}  // namespace cdiff::evaluation
