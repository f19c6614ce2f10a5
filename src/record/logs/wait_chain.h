// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::record {

/// What stands in the way of one vehicle.
struct Wait {
  enum class For {
    kVehicle,   ///< one ahead on its way, or in the junction that it waits at
    kLight,     ///< a traffic light that is not green
    kStopLine,  ///< a stop sign
    kNothing    ///< its way is free as far as traffic and lights show
  };
  std::string vehicle;  ///< who waits
  For reason = For::kNothing;
  std::string obstacle;  ///< id of the vehicle or light; else empty
  std::string junction;  ///< where it waits at a junction or in it; empty in a queue
};

/// Who waits for whom, from the ego on: each element's obstacle is the vehicle of the next one.
struct WaitChain {
  std::vector<Wait> waits;  ///< the ego's first; none after a vehicle that drives
  bool ring = false;        ///< the last one waits for a vehicle of the chain

  /// Vehicles of the queue that the ego stands in, the one before it first, the head last.
  std::vector<std::string> queue() const;
};

/// Follows the traffic from the ego along its route, then from vehicle to vehicle along their
/// lanes: the nearest vehicle within 20 m ahead of the front bumper; at a junction within 15 m its
/// light or stop line, then the nearest vehicle in the junction, at its exits or at its other
/// entries. A vehicle faster than 0.5 m/s waits for nothing. Ties by id. Empty without an ego.
WaitChain waitChain(const traffic::TrafficSnapshot& snapshot, const map::RoadNetwork& network,
                    const map::Route& ego_route);

}  // namespace cdiff::record
