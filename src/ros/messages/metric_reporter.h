// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "e2e_cdiff/MetricReport.h"
#include "metrics/session_metrics.h"
#include "session/session_setup.h"

namespace cdiff::ros {

/// The session's metrics as messages: one report per decision; all measures in it once in a
/// simulated second and at the end.
class MetricReporter {
 public:
  /// `setup` must outlive the object.
  explicit MetricReporter(const session::SessionSetup& setup);

  /// Call at every tick, in order; nullptr at ticks without a report. `selection` is nullptr
  /// between decisions.
  ::e2e_cdiff::MetricReport::ConstPtr observe(const traffic::TrafficSnapshot& snapshot,
                                              const cbv::CbvSelection* selection);
  /// All measures as of the last report that held them.
  const metrics::SessionMeasures& session() const { return session_; }

 private:
  metrics::SessionMetrics metrics_;
  std::string protocol_;  ///< preset
  metrics::SessionMeasures session_;
  std::uint64_t decisions_per_report_;
  std::uint64_t decisions_ = 0;
};

// A session's measures so far as keys and values of /diagnostics.

/// The main measures, each "value unit (n = ...)" or "not defined: reason" under its label; then
/// under "not defined: REASON" the names of all measures that have no value for it.
std::vector<std::pair<std::string, std::string>> metricDiagnostics(
    const metrics::SessionMeasures& measures);

}  // namespace cdiff::ros
