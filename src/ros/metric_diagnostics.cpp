// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/metric_diagnostics.h"

#include <map>

#include "core/text.h"
#include "metrics/metric_registry.h"
#include "record/session_table.h"

namespace cdiff::ros {
namespace {

std::string valueText(const metrics::FigureDefinition& figure, const metrics::Measure& measure) {
  if (measure.unit == "count" && measure.value) return core::formatNumber(*measure.value);
  return record::measureText(measure, figure.decimals);
}

}  // namespace

std::vector<std::pair<std::string, std::string>> metricDiagnostics(
    const metrics::SessionMeasures& measures) {
  std::vector<std::pair<std::string, std::string>> values;
  std::map<std::string, std::vector<std::string>> undefined;
  for (const metrics::FigureDefinition& figure : metrics::figureDefinitions()) {
    const metrics::Measure measure = measures.at(figure);
    if (figure.main) values.emplace_back(figure.label, valueText(figure, measure));
    if (!measure.value) undefined[measure.reason].emplace_back(figure.name);
  }
  for (const auto& [reason, names] : undefined)
    values.emplace_back("not defined: " + reason, core::joinText(names, ", "));
  return values;
}

}  // namespace cdiff::ros
