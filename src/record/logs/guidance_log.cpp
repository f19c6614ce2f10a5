// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/logs/guidance_log.h"

#include <algorithm>

namespace cdiff::record {

void GuidanceLog::observe(const session::TickRecord& record) {
  if (record.actions == nullptr) return;
  for (const planning::PlannedAction& action : *record.actions) {
    if (action.slot < 0 || action.guidance.objectives.empty()) continue;
    trust_region_shares_.push_back(action.guidance.trust_region_share);
    for (const guidance::ObjectiveReport& report : action.guidance.objectives) {
      seriesOf(report.name).samples.push_back({record.snapshot->time, action.vehicle_id, report});
    }
  }
}

GuidanceSeries& GuidanceLog::seriesOf(const std::string& objective) {
  const auto known =
      std::find_if(series_.begin(), series_.end(),
                   [&](const GuidanceSeries& series) { return series.objective == objective; });
  if (known != series_.end()) return *known;
  series_.push_back({objective, {}});
  return series_.back();
}

ObjectiveSummary summaryOf(const GuidanceSeries& series) {
  const auto mean = [&](double guidance::ObjectiveReport::*quantity) {
    std::vector<double> values;
    for (const GuidanceSample& sample : series.samples) values.push_back(sample.report.*quantity);
    return summaryOf(values).mean;
  };
  ObjectiveSummary summary;
  if (!series.samples.empty()) summary.weight = series.samples.back().report.weight;
  summary.value = mean(&guidance::ObjectiveReport::value);
  summary.gradient_norm = mean(&guidance::ObjectiveReport::gradient_norm);
  summary.capped_share = mean(&guidance::ObjectiveReport::capped_share);
  for (const GuidanceSample& sample : series.samples) summary.dropped += sample.report.dropped;
  summary.n = series.samples.size();
  return summary;
}

}  // namespace cdiff::record
