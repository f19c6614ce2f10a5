// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "e2e_cdiff/map/road_network.h"
#include "e2e_cdiff/metrics/infraction_options.h"
#include "e2e_cdiff/metrics/metrics_options.h"

namespace cdiff::metrics {

/// What the metrics of a session know about its scenario (SI units).
struct SessionMetricsOptions {
  double simulation_step = 0.05;          ///< [s]
  double decision_period = 0.1;           ///< [s]
  double completion_percent = 99.0;       ///< the protocol's bound on route completion
  double completion_distance = 10.0;      ///< the protocol's bound on the distance to the goal [m]
  std::string protocol = "rift_dev10";    ///< name of the preset
  std::string mode = "naturalistic";      ///< naturalistic | safety_critical
  InfractionOptions infractions;          ///< its rules for the ego
  double ttc_radius = 60.0;               ///< vehicles considered for 2D-TTC [m]
  double ttc_limit = 3600.0;              ///< a longer 2D-TTC counts as never [s]
  double post_encroachment_limit = 10.0;  ///< a longer time counts as never [s]
  double target_speed = 8.0;              ///< that CBVs aim at, capped by the lane's limit [m/s]
  const map::RoadNetwork* network =
      nullptr;             ///< for that limit and the ego's infractions; nullptr: without
  MetricsOptions metrics;  ///< what the scenario asks for
};

}  // namespace cdiff::metrics
