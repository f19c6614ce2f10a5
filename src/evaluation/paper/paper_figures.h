// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "evaluation/paper/paper_table.h"
#include "evaluation/run_record.h"
#include "page/pictures/map_canvas.h"
#include "page/pictures/panel_sheet.h"

namespace cdiff::evaluation {

// Figures 3 to 8 of the paper as a batch fills them: numbers as CSV and a picture.

/// A figure, filled from a batch: numbers as CSV and a sheet of pictures.
struct Figure {
  std::string id;  ///< "figure_3", "trails", also the name of its files
  std::string csv;
  page::PanelSheet sheet;
  bool wall_clock = false;  ///< whether its numbers are wall-clock times
};

/// One line of systems that a figure compares.
struct ShownSystem {
  std::string name;
  Factors levels;
};

/// The paper's CBV planners, then those that the batch has besides, by name: ego PDM-Lite,
/// naturalistic.
std::vector<ShownSystem> shownCbvPlanners(const std::vector<BatchRun>& runs);

/// Complete runs with these levels.
std::vector<const BatchRun*> completeRuns(const std::vector<BatchRun>& runs, const Factors& levels);
std::size_t countSeeds(const std::vector<const BatchRun*>& runs);

/// Figure 3: speeds and accelerations of CBVs at decisions, pooled over the runs of a planner; W of
/// Shapiro and Wilk on at most 5000 of them (every k-th).
Figure distributionFigure(const std::vector<BatchRun>& runs);

/// A table's rows as groups of bars, its columns as bars with their 95 % intervals, beside the
/// paper's. One unit for all columns.
Figure barFigure(const TableDefinition& definition, const std::vector<BatchRun>& runs);

/// Figures 5 and 6: a row per system, three frames from above around the closest approach of ego
/// and CBV (-1.5, 0, +1 s), all of one scenario and seed: the one that most systems drove with a
/// CBV, of these the one with the smallest distance in any run.
Figure frameFigure(const std::string& id, const std::string& title,
                   const std::vector<ShownSystem>& systems, const std::vector<BatchRun>& runs);

/// Figure 7: planned against driven states over the plan's horizon, end-to-end and two-stage.
Figure executionFigure(const std::vector<BatchRun>& runs);

/// All of the paper's.
std::vector<Figure> paperFigures(const std::vector<BatchRun>& runs);

/// The map of a run; nullptr, with a note on the sheet, when the network is no longer there.
std::unique_ptr<session::SessionSetup> roadsOf(const BatchRun& run, page::PanelSheet& sheet);
/// What lies below the vehicles of a picture from above: the ground and, of a map, the roads.
core::Markup groundSvg(const session::SessionSetup* setup, const page::MapCanvas& canvas);

}  // namespace cdiff::evaluation
