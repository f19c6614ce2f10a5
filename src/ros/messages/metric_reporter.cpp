// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/messages/metric_reporter.h"

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cmath>
#include <map>

#include "core/text.h"
#include "metrics/metric_registry.h"
#include "record/session_text.h"
#include "ros/messages/conversions.h"

namespace cdiff::ros {
namespace {

/// Measures of the whole session go out once in a simulated second.
std::uint64_t decisionsPerReport(const session::SessionSetup& setup) {
  const double decisions = 1.0 / setup.options().decision_period;
  return static_cast<std::uint64_t>(std::max(1L, std::lround(decisions)));
}

}  // namespace

MetricReporter::MetricReporter(const session::SessionSetup& setup)
    : metrics_(setup.metricsOptions(), setup.drivableArea(), setup.egoRoute()),
      protocol_(setup.options().protocol.preset),
      decisions_per_report_(decisionsPerReport(setup)) {}

msgs::MetricReport::ConstPtr MetricReporter::observe(const traffic::TrafficSnapshot& snapshot,
                                                     const cbv::CbvSelection* selection) {
  const metrics::TickMeasures measures = metrics_.observe(snapshot, selection);
  const bool final = snapshot.status != traffic::SessionStatus::kRunning;
  if (!snapshot.decision_tick && !final) return nullptr;
  msgs::MetricReport report = toMsg(measures, snapshot);
  report.protocol = protocol_;
  const bool due = snapshot.decision_tick && decisions_++ % decisions_per_report_ == 0;
  if (due || final) {
    session_ = metrics_.measures();
    report.measures = toMsg(session_);
  }
  return boost::make_shared<const msgs::MetricReport>(report);
}

namespace {

std::string valueText(const metrics::MeasureDefinition& definition,
                      const metrics::Measure& measure) {
  if (measure.unit == "count" && measure.value) return core::formatNumber(*measure.value);
  return record::measureText(measure, definition.decimals);
}

}  // namespace

std::vector<std::pair<std::string, std::string>> metricDiagnostics(
    const metrics::SessionMeasures& measures) {
  std::vector<std::pair<std::string, std::string>> values;
  std::map<std::string, std::vector<std::string>> undefined;
  for (const metrics::MeasureDefinition& definition : metrics::measureDefinitions()) {
    const metrics::Measure measure = measures.at(definition);
    if (definition.main) values.emplace_back(definition.label, valueText(definition, measure));
    if (!measure.value) undefined[measure.reason].emplace_back(definition.name);
  }
  for (const auto& [reason, names] : undefined)
    values.emplace_back("not defined: " + reason, core::joinText(names, ", "));
  return values;
}

}  // namespace cdiff::ros
