// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "evaluation/paper/paper_figures.h"
#include "evaluation/run_record.h"
#include "page/pictures/map_canvas.h"
#include "page/pictures/panel_sheet.h"

namespace cdiff::evaluation {

/// Figures 5 and 6: a row per system, three frames from above around the closest approach of ego
/// and CBV (-1.5, 0, +1 s), all of one scenario and seed: the one that most systems drove with a
/// CBV, of these the one with the smallest distance in any run.
Figure frameFigure(const std::string& id, const std::string& title,
                   const std::vector<ShownSystem>& systems, const std::vector<BatchRun>& runs);

/// The map of a run; nullptr, with a note on the sheet, when the network is no longer there.
std::unique_ptr<session::SessionSetup> roadsOf(const BatchRun& run, page::PanelSheet& sheet);
/// What lies below the vehicles of a picture from above: the ground and, of a map, the roads.
core::Markup groundSvg(const session::SessionSetup* setup, const page::MapCanvas& canvas);

}  // namespace cdiff::evaluation
