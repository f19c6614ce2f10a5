// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "core/markup.h"
#include "evaluation/ranking.h"

namespace cdiff::evaluation {

/// A table of scenarios (rows, hardest first) against systems (columns, in the order of the
/// ranking): contacts of the ego by partner, those at its fault, the mean driving score. Color and
/// order go by contacts of the moving ego (per run), which the ranking goes by. A cell links to its
/// runs in the table below.
core::Markup heatMap(const std::vector<RunRecord>& records, const Ranking& ranking,
                     const SystemNames& names);

}  // namespace cdiff::evaluation
