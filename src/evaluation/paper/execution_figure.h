// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "evaluation/paper/paper_figures.h"
#include "evaluation/run_record.h"

namespace cdiff::evaluation {

/// Figure 7: planned against driven states over the plan's horizon, end-to-end and two-stage.
Figure executionFigure(const std::vector<BatchRun>& runs);

}  // namespace cdiff::evaluation
