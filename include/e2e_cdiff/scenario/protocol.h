// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Protocol presets and the rules by which a session ends: completed, blocked, deviated, timed out,
/// collided.
#pragma once

#include <string>

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/map/route_progress.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::scenario {

/// Defaults: rift_dev10 (RIFT's protocol on Bench2Drive's ten development routes).
struct ProtocolOptions {
  std::string preset = "rift_dev10";  ///< name of the rules
  double time_limit = 40.0;           ///< simulated [s]
  double blocked_time = 3.0;   ///< slower than blocked_speed for this long ends the session [s]
  double blocked_speed = 0.1;  ///< [m/s]
  double deviation_distance = 30.0;   ///< from the ego route ends the session [m]
  double completion_percent = 99.0;   ///< of the route's length ...
  double completion_distance = 10.0;  ///< ... and this near its end counts as 100 % [m]
  bool end_on_collision = false;      ///< the first contact of the ego ends the session

  void describe(core::OptionsVisitor& visitor);
};

/// Follows the ego along its route and says how the session stands. One call per tick, in order.
class ProtocolMonitor {
 public:
  /// `route` must outlive the monitor.
  ProtocolMonitor(const ProtocolOptions& options, const map::Route& route);
  traffic::SessionStatus update(const traffic::TrafficSnapshot& snapshot);
  double routeCompletionPercent() const { return progress_.percent(); }

 private:
  ProtocolOptions options_;
  map::RouteProgress progress_;
  double standing_since_ = -1.0;
};

}  // namespace cdiff::scenario
