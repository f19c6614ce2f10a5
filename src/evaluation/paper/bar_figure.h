// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "evaluation/paper/paper_figures.h"
#include "evaluation/paper/paper_table.h"
#include "evaluation/run_record.h"

namespace cdiff::evaluation {

/// A table's rows as groups of bars, its columns as bars with their 95 % intervals, beside the
/// paper's. One unit for all columns.
Figure barFigure(const TableDefinition& definition, const std::vector<BatchRun>& runs);

}  // namespace cdiff::evaluation
