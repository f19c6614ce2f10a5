// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/session_measures.h"

#include <utility>

#include "e2e_cdiff/core/exceptions.h"
#include "metrics/metric_registry.h"

namespace cdiff::metrics {

Measure SessionMeasures::at(const FigureDefinition& figure) const {
  const auto found = measures_.find(figure.name);
  if (found != measures_.end()) return found->second;
  return {std::nullopt, 0, figure.unit, "not computed"};
}

Measure SessionMeasures::at(const std::string& name) const {
  const FigureDefinition* figure = findFigure(name);
  if (figure == nullptr) throw core::InputError("'" + name + "' is no figure of a session");
  return at(*figure);
}

void SessionMeasures::set(const FigureDefinition& figure, Measure measure) {
  measure.unit = figure.unit;
  measures_[figure.name] = std::move(measure);
}

}  // namespace cdiff::metrics
