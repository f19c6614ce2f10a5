// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What is counted of the ego: route completion [%], contacts, time with its centre off the
/// drivable area, infractions of the protocol.
#pragma once

#include <optional>
#include <string>

#include "e2e_cdiff/map/route_progress.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "metrics/ego_infractions.h"
#include "metrics/off_road_rate.h"

namespace cdiff::metrics {

class EgoMeasures {
 public:
  /// `route` must outlive the object; an empty one completes nothing.
  EgoMeasures(const map::Route& route, double completion_percent, double completion_distance,
              EgoInfractions infractions);

  /// One tick of the ego.
  void observe(const traffic::Vehicle& ego, bool off_road,
               const traffic::TrafficSnapshot& snapshot);
  /// A contact of the ego that began at this tick.
  void countCollision(const traffic::TrafficSnapshot& snapshot, const traffic::Contact& contact);
  /// Id of the ego; empty before the first tick.
  const std::string& id() const { return id_; }

  double routeCompletionPercent() const;
  std::size_t collisions() const { return collisions_; }
  Measure offRoadPercent() const;
  const EgoInfractions& infractions() const { return infractions_; }
  /// By the protocol: completion x penalty [%].
  double drivingScore() const;

 private:
  std::optional<map::RouteProgress> progress_;
  std::string id_;
  OffRoadRate off_road_;
  EgoInfractions infractions_;
  std::size_t collisions_ = 0;
};

}  // namespace cdiff::metrics
