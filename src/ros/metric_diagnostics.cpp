// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/metric_diagnostics.h"

#include <map>

#include "core/text.h"
#include "metrics/figure_definitions.h"
#include "record/session_table.h"

namespace cdiff::ros {
namespace {

/// Names of the figures shown one by one.
constexpr const char* kMain[] = {
    "ego_completion_percent",
    "ego_driving_score",
    "ego_collisions",
    "cbv_count",
    "cbv_off_road_percent",
    "cbv_uncomfortable_percent",
    "cbv_collisions_per_km",
    "ttc_mean_s",
    "ttc_min_s",
    "ttc_cbv_min_s",
    "post_encroachment_min_s",
    "speed_shapiro_wilk",
    "speed_wasserstein_mps",
    "acceleration_shapiro_wilk",
};

std::string valueText(const metrics::Measure& measure) {
  if (measure.unit == "count" && measure.value) return core::formatNumber(*measure.value);
  return record::measureText(measure, 3);
}

}  // namespace

std::vector<std::pair<std::string, std::string>> metricDiagnostics(
    const metrics::SessionMeasures& measures) {
  std::vector<std::pair<std::string, std::string>> values;
  for (const char* name : kMain) {
    if (const metrics::FigureDefinition* figure = metrics::findFigure(name))
      values.emplace_back(figure->label, valueText(figure->measure(measures)));
  }
  std::map<std::string, std::vector<std::string>> undefined;
  for (const metrics::FigureDefinition& figure : metrics::figureDefinitions()) {
    const metrics::Measure measure = figure.measure(measures);
    if (!measure.value) undefined[measure.reason].emplace_back(figure.name);
  }
  for (const auto& [reason, names] : undefined)
    values.emplace_back("not defined: " + reason, core::joinText(names, ", "));
  return values;
}

}  // namespace cdiff::ros
