// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Rows of the table of figures, by part of summary.json.
#pragma once

#include "metrics/figure_definitions.h"

namespace cdiff::metrics {

using FigureRows = std::vector<FigureDefinition>;
using M = SessionMeasures;  ///< in the rows' last column

inline Measure numberMeasure(double value, const char* unit) { return {value, 1, unit, {}, {}}; }
inline Measure countMeasure(std::size_t count) {
  return numberMeasure(static_cast<double>(count), "count");
}

FigureRows egoFigures();
FigureRows cbvFigures();
FigureRows interactionFigures();
FigureRows motionFigures();
FigureRows riftFigures();

}  // namespace cdiff::metrics
