// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Measures a session from its snapshots and selections alone: the same online, from a bag, and in
/// one process.
#pragma once

#include <memory>
#include <optional>

#include "e2e_cdiff/metrics/metric.h"
#include "metrics/session_measures.h"

namespace cdiff::metrics {

/// Figures of one tick, for the live topic.
struct TickMeasures {
  std::optional<double> ttc_2d;            ///< minimum over vehicles near the ego [s]
  std::optional<double> nearest_distance;  ///< ego's box to the nearest other box [m]
  double route_completion_percent = 0.0;
  double ego_speed = 0.0;
  bool ego_off_road = false;
  std::size_t cbv_off_road = 0;  ///< CBVs now off the drivable area
};

/// All registered metrics of one session.
class SessionMetrics {
 public:
  /// References must outlive the object.
  SessionMetrics(const SessionMetricsOptions& options, const map::DrivableArea& drivable_area,
                 const map::Route& ego_route);
  ~SessionMetrics();

  /// One tick in order; `selection` at decision ticks, else nullptr.
  TickMeasures observe(const traffic::TrafficSnapshot& snapshot,
                       const cbv::CbvSelection* selection);
  /// The figures so far.
  SessionMeasures measures() const;

 private:
  class Metrics;
  std::unique_ptr<Metrics> metrics_;
};

}  // namespace cdiff::metrics
