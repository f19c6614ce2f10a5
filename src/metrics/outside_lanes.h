// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Share [%] of the completed route that the ego drove outside the lanes, as CARLA's
/// OutsideRouteLanesTest has it: its centre farther than half a lane's width plus a margin from
/// every lane on its level, or the nearest lane outside junctions leading the other way.
#pragma once

#include "e2e_cdiff/map/road_network.h"
#include "e2e_cdiff/metrics/infraction_options.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::metrics {

/// The rule at one tick. False for a position that is not finite.
bool isOutsideLanes(const map::RoadNetwork& network, const traffic::VehicleState& ego,
                    const InfractionOptions& options);

class OutsideLanes {
 public:
  /// `network` must outlive the object.
  OutsideLanes(const map::RoadNetwork& network, const InfractionOptions& options)
      : network_(network), options_(options) {}

  /// One tick, by which the ego has come `advance` farther along its route [m].
  void observe(const traffic::VehicleState& ego, double advance);
  std::size_t ticks() const { return ticks_; }
  /// 0 before the ego has advanced.
  double percent() const { return advance_ > 0.0 ? 100.0 * outside_ / advance_ : 0.0; }

 private:
  const map::RoadNetwork& network_;
  InfractionOptions options_;
  std::size_t ticks_ = 0;
  double advance_ = 0.0;
  double outside_ = 0.0;
};

}  // namespace cdiff::metrics
