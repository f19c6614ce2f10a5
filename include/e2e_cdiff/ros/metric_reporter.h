// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The session's metrics as messages: one report per decision, and one with all figures at the end.
#pragma once

#include <string>

#include "e2e_cdiff/MetricReport.h"
#include "e2e_cdiff/metrics/session_metrics.h"
#include "e2e_cdiff/scenario/session_setup.h"

namespace cdiff::ros {

class MetricReporter {
 public:
  /// `setup` must outlive the object.
  explicit MetricReporter(const scenario::SessionSetup& setup);

  /// Call at every tick, in order; nullptr at ticks without a report. `selection` is nullptr
  /// between decisions.
  ::e2e_cdiff::MetricReport::ConstPtr observe(const traffic::TrafficSnapshot& snapshot,
                                              const cbv::CbvSelection* selection);

 private:
  metrics::SessionMetrics metrics_;
  std::string protocol_;  ///< preset
};

}  // namespace cdiff::ros
