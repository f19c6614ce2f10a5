// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/ros/metric_reporter.h"

#include <boost/make_shared.hpp>

#include "e2e_cdiff/ros/conversions.h"

namespace cdiff::ros {
MetricReporter::MetricReporter(const scenario::SessionSetup& setup)
    : metrics_(setup.metricsOptions(), setup.drivableArea(), setup.egoRoute()),
      protocol_(setup.options().protocol.preset) {}

msgs::MetricReport::ConstPtr MetricReporter::observe(const traffic::TrafficSnapshot& snapshot,
                                                     const cbv::CbvSelection* selection) {
  const metrics::TickMeasures measures = metrics_.observe(snapshot, selection);
  const bool final = snapshot.status != traffic::SessionStatus::kRunning;
  if (!snapshot.decision_tick && !final) return nullptr;
  msgs::MetricReport report = toMsg(measures, snapshot);
  report.protocol = protocol_;
  if (final) report.measures = toMsg(metrics_.measures());
  return boost::make_shared<const msgs::MetricReport>(report);
}

}  // namespace cdiff::ros
