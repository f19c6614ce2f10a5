// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "evaluation/paper/paper_systems.h"
#include "evaluation/paper/paper_table.h"

namespace cdiff::evaluation {

// What is published besides the paper's own figures, and what a reader must know to compare: the
// values that RIFT's repository prints for its CBV planners, and in what protocol and training the
// published systems differ from ours.

/// The value that RIFT's repository (eval.ipynb at 49d643c; routes dev10, three seeds) prints in
/// the column of this name ("2D-TTC", "ORR", "S-SW", "A-SW", "S-WD", "DS", "RC", "speed",
/// "acceleration") for a CBV planner under an ego planner; nothing where it prints none.
PaperFigure repositoryFigure(const PaperSystem& ego, const PaperSystem& cbv,
                             const std::string& column);

/// "PPO 6.60 ± 4.03, Pluto 4.01 ± 3.69, RIFT 5.38 ± 3.23 m/s": a column of the CBV planners under
/// an ego planner, as the repository prints it.
std::string repositoryList(const PaperSystem& ego, const std::string& column,
                           const std::string& unit);

/// A line "Pluto: ..." for each of these systems: how training and execution of the published one
/// differ from ours.
std::vector<std::string> systemDifferences(const std::vector<PaperSystem>& systems);

/// Under which protocol the published figures were measured, in one line.
extern const char* const kPublishedProtocol;

}  // namespace cdiff::evaluation
