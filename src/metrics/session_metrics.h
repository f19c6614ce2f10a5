// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Measures a session from its snapshots and selections alone: the same online, from a bag, and in
/// one process.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "e2e_cdiff/cbv/cbv_selection.h"
#include "e2e_cdiff/map/drivable_area.h"
#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "metrics/infraction_options.h"
#include "metrics/metrics_options.h"
#include "metrics/session_measures.h"

namespace cdiff::metrics {

struct SessionMetricsOptions {
  double simulation_step = 0.05;          ///< [s]
  double decision_period = 0.1;           ///< [s]
  double completion_percent = 99.0;       ///< of the protocol
  double completion_distance = 10.0;      ///< of the protocol [m]
  std::string protocol = "rift_dev10";    ///< name of the preset
  InfractionOptions infractions;          ///< its rules for the ego
  double ttc_radius = 60.0;               ///< vehicles considered for 2D-TTC [m]
  double ttc_limit = 3600.0;              ///< a longer 2D-TTC counts as never [s]
  double post_encroachment_limit = 10.0;  ///< a longer time counts as never [s]
  double target_speed = 8.0;              ///< that CBVs aim at, capped by the lane's limit [m/s]
  const map::RoadNetwork* network =
      nullptr;             ///< for that limit and the ego's infractions; nullptr: without
  MetricsOptions metrics;  ///< what the scenario asks for
};

/// Figures of one tick, for the live topic.
struct TickMeasures {
  std::optional<double> ttc_2d;            ///< minimum over vehicles near the ego [s]
  std::optional<double> nearest_distance;  ///< ego's box to the nearest other box [m]
  double route_completion_percent = 0.0;
  double ego_speed = 0.0;
  bool ego_off_road = false;
  std::size_t cbv_off_road = 0;  ///< CBVs now off the drivable area
};

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
  class Accumulator;
  std::unique_ptr<Accumulator> accumulator_;
};

}  // namespace cdiff::metrics
