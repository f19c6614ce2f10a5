// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The ego's infractions by a protocol's rules, from snapshots alone, and what they make of the
/// driving score [%].
#pragma once

#include <map>
#include <optional>
#include <string>

#include "e2e_cdiff/map/route.h"
#include "metrics/collision_counter.h"
#include "metrics/minimum_speed.h"
#include "metrics/outside_lanes.h"
#include "metrics/session_measures.h"
#include "metrics/stop_lines.h"

namespace cdiff::metrics {

class EgoInfractions {
 public:
  /// `network` (nullptr: what needs it is absent) and `route` must outlive the object; an empty
  /// route has no minimum speed.
  EgoInfractions(const map::RoadNetwork* network, const map::Route& route,
                 const InfractionOptions& options);

  /// One tick of the ego, `arc_length` [m] along its route. Call before countCollision.
  void observe(const traffic::Vehicle& ego, const traffic::TrafficSnapshot& snapshot,
               double arc_length);
  /// A contact that began at this tick.
  void countCollision(const traffic::TrafficSnapshot& snapshot, const std::string& partner);

  /// In [0, 1]; n = ticks of the ego. Absent before the first.
  Measure penalty() const;
  /// In percent, from a route completion in percent; 0 before the first tick.
  double drivingScore(double route_completion_percent) const;
  /// By name: counts, outside_lanes_percent and minimum_speed_percent; kinds that cannot occur here
  /// are absent with the reason.
  std::map<std::string, Measure> measures() const;

 private:
  Infractions infractions() const;
  void addRoadMeasures(std::map<std::string, Measure>& measures) const;
  void addSpeedMeasures(std::map<std::string, Measure>& measures) const;

  InfractionOptions options_;
  CollisionCounter collisions_;
  MinimumSpeed minimum_speed_;
  std::optional<OutsideLanes> outside_;
  std::optional<StopLines> stop_lines_;
  double arc_length_ = 0.0;
  std::size_t ticks_ = 0;
};

}  // namespace cdiff::metrics
