// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "evaluation/run_record.h"
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

/// All of the paper's.
std::vector<Figure> paperFigures(const std::vector<BatchRun>& runs);

}  // namespace cdiff::evaluation
