// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/metrics/metrics_options.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::session {

/// The rules by which a session ends (completed, blocked, deviated, timed out, collided), as a
/// preset or key by key. Defaults: rift_dev10 (RIFT's protocol on Bench2Drive's ten development
/// routes).
struct ProtocolOptions {
  std::string preset = "rift_dev10";      ///< name of the rules
  double time_limit = 40.0;               ///< simulated [s]
  double time_limit_speed_percent = 0.0;  ///< p > 0: the limit grows by the integral of ds / (p %
                                          ///< of the lane's speed limit) over the progress
  double blocked_time = 3.0;   ///< slower than blocked_speed for this long ends the session [s]
  double blocked_speed = 0.1;  ///< [m/s]
  double deviation_distance = 30.0;  ///< from the ego route ends the session [m]
  double deviation_safe_distance =
      15.0;                           ///< and so does progress made at this distance or more [m]
  double deviation_percent = 30.0;    ///< ... over more than this share of the route [%]
  double completion_percent = 99.0;   ///< least share of the route's length ...
  double completion_distance = 10.0;  ///< ... and this near its end counts as 100 % [m]
  bool end_on_collision = false;      ///< the first contact of the ego ends the session
  metrics::InfractionOptions infractions;  ///< infractions of the ego; their keys lie beside these

  void describe(core::OptionsVisitor& visitor);
};

/// The rules of a preset in config/protocols. Throws InputError naming file, line and key, or the
/// nearest preset.
ProtocolOptions loadProtocol(const std::string& preset);

/// Names of the presets, sorted.
std::vector<std::string> shippedProtocols();

/// Time by which a session along this route has timed out at the latest [s].
double longestTime(const ProtocolOptions& options, const map::Route& route);

/// Follows the ego along its route and says how the session stands. One call per tick, in order.
class ProtocolMonitor {
 public:
  /// `route` must outlive the monitor.
  ProtocolMonitor(const ProtocolOptions& options, const map::Route& route);
  traffic::SessionStatus update(const traffic::TrafficSnapshot& snapshot);
  double routeCompletionPercent() const { return progress_.percent(); }

  /// Time since which the ego has been standing [s]; nullopt while it drives.
  std::optional<double> standingSince() const { return standing_since_; }
  /// As long as it is withheld, standing does not end the session; its time counts on.
  void withholdBlocked(bool withheld) { blocked_withheld_ = withheld; }

 private:
  /// After the ego has come `advance` farther along its route [m].
  bool deviates(double advance);
  bool stands(double time, double speed);

  ProtocolOptions options_;
  const map::Route* route_;
  map::RouteProgress progress_;
  double time_limit_;               ///< now [s]
  double deviated_distance_ = 0.0;  ///< progress made too far from the route [m]
  std::optional<double> standing_since_;
  bool blocked_withheld_ = false;
};

}  // namespace cdiff::session
