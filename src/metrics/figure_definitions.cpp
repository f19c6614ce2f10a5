// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/figure_definitions.h"

#include <algorithm>

#include "metrics/figure_rows.h"

namespace cdiff::metrics {

const char* toText(Direction direction) {
  switch (direction) {
    case Direction::kHigherIsBetter:
      return "higher is better";
    case Direction::kLowerIsBetter:
      return "lower is better";
    case Direction::kNeither:
      break;
  }
  return "no direction";
}

const std::vector<FigureDefinition>& figureDefinitions() {
  static const FigureRows all = [] {
    FigureRows rows;
    for (const FigureRows& part :
         {egoFigures(), cbvFigures(), interactionFigures(), motionFigures(), riftFigures()}) {
      rows.insert(rows.end(), part.begin(), part.end());
    }
    return rows;
  }();
  return all;
}

const FigureDefinition* findFigure(const std::string& name) {
  const auto& all = figureDefinitions();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const FigureDefinition& row) { return name == row.name; });
  return found == all.end() ? nullptr : &*found;
}

}  // namespace cdiff::metrics
