// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "evaluation/paper/paper_table.h"

namespace cdiff::evaluation {

// What the paper's tables and figures show, as data: rows and columns with the levels of their
// runs, the keys of the measures, and the values that the paper prints.

/// Tables 1 to 6.
std::vector<TableDefinition> paperTables();
/// Figures 4 (collisions per km) and 8 (latency), which are tables shown as bars.
TableDefinition collisionFigure();
TableDefinition latencyFigure();

}  // namespace cdiff::evaluation
