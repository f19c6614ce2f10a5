// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What is counted of the ego: route completion [%], collisions, time and distance [m] with its
/// centre off the drivable area.
#pragma once

#include <optional>
#include <string>

#include "e2e_cdiff/map/route_progress.h"
#include "e2e_cdiff/metrics/off_road_rate.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::metrics {

class EgoMeasures {
 public:
  /// `route` must outlive the object; an empty one completes nothing.
  EgoMeasures(const map::Route& route, double completion_percent, double completion_distance);

  /// One tick of the ego.
  void observe(const traffic::Vehicle& ego, bool off_road);
  void countCollision() { ++collisions_; }
  /// Id of the ego; empty before the first tick.
  const std::string& id() const { return id_; }

  double routeCompletionPercent() const;
  std::size_t collisions() const { return collisions_; }
  Measure offRoadPercent() const;
  /// Share of the driven distance that ended a tick off the drivable area [%]; 0 when the ego did
  /// not move.
  double outsidePercent() const;
  /// By the rules of rift_dev10: completion x 0.6^collisions x (1 - outside share).
  double drivingScore() const;

 private:
  std::optional<map::RouteProgress> progress_;
  std::optional<Eigen::Vector2d> last_position_;
  std::string id_;
  OffRoadRate off_road_;
  double distance_ = 0.0;
  double outside_distance_ = 0.0;
  std::size_t collisions_ = 0;
};

}  // namespace cdiff::metrics
