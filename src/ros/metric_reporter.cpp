// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/ros/metric_reporter.h"

#include <boost/make_shared.hpp>

#include "e2e_cdiff/ros/conversions.h"

namespace cdiff::ros {
namespace {

metrics::SessionMetricsOptions metricsOptions(const scenario::ScenarioOptions& options) {
  metrics::SessionMetricsOptions result;
  result.simulation_step = options.simulation_step;
  result.completion_percent = options.protocol.completion_percent;
  result.completion_distance = options.protocol.completion_distance;
  return result;
}

}  // namespace

MetricReporter::MetricReporter(const scenario::SessionSetup& setup)
    : metrics_(metricsOptions(setup.options()), setup.drivableArea(), setup.egoRoute()) {}

msgs::MetricReport::ConstPtr MetricReporter::observe(const traffic::TrafficSnapshot& snapshot,
                                                     const cbv::CbvSelection* selection) {
  const metrics::TickMeasures measures = metrics_.observe(snapshot, selection);
  const bool final = snapshot.status != traffic::SessionStatus::kRunning;
  if (!snapshot.decision_tick && !final) return nullptr;
  msgs::MetricReport report = toMsg(measures, snapshot);
  if (final) report.measures = toMsg(metrics_.measures());
  return boost::make_shared<const msgs::MetricReport>(report);
}

}  // namespace cdiff::ros
