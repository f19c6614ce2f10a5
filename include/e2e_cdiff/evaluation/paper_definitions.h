// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What the paper's tables and figures show: the systems by their names there, the levels that a
/// run of each has here, the keys of the figures, and the values that the paper prints.
#pragma once

#include <string>
#include <vector>

#include "e2e_cdiff/evaluation/paper_table.h"

namespace cdiff::evaluation {

/// A system of the paper and the planner that it is here, whether it exists yet or not.
struct PaperSystem {
  const char* name;     ///< "E2E-CDiff"
  const char* planner;  ///< "diffusion"
};

/// In the paper's order.
const std::vector<PaperSystem>& paperEgoPlanners();
const std::vector<PaperSystem>& paperCbvPlanners();
/// Two-stage and end-to-end.
const std::vector<PaperSystem>& paperExecutions();

/// Levels of runs without and with collision-seeking guidance.
Factors naturalisticLevels();
Factors safetyCriticalLevels();

/// Tables 1 to 6.
std::vector<TableDefinition> paperTables();
/// Figures 4 (collisions per km) and 8 (latency), which are tables shown as bars.
TableDefinition collisionFigure();
TableDefinition latencyFigure();

}  // namespace cdiff::evaluation
