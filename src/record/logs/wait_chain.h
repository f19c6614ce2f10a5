// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "session/demand_file.h"

namespace cdiff::record {

/// What stands in the way of one vehicle.
struct Wait {
  enum class For {
    kVehicle,   ///< one ahead on its way, or in the junction that it waits at
    kLight,     ///< a traffic light that is not green
    kStopLine,  ///< a stop sign
    kStop,      ///< a stop that the demand file orders
    kNoWay,     ///< its lane ends and leads nowhere
    kNothing    ///< its way is free as far as traffic and lights show
  };
  std::string vehicle;  ///< who waits
  For reason = For::kNothing;
  std::string obstacle;    ///< id of the vehicle or light, lane of the stop or end; else empty
  std::string junction;    ///< where it waits at a junction or in it; empty in a queue
  bool yields = false;     ///< lets the vehicle pass that comes through the junction
  std::string until = {};  ///< of a demand's stop: "until 600 s of SUMO's clock"; else empty
};

/// What is known of the demand, besides the traffic.
struct KnownDemand {
  const session::DemandFile* file = nullptr;  ///< may be missing
  double clock = 0.0;                         ///< SUMO's clock at the snapshot [s]
};

/// Who waits for whom, from the ego on: each element's obstacle is the vehicle of the next one.
struct WaitChain {
  std::vector<Wait> waits;  ///< the ego's first; none after a vehicle that drives
  bool ring = false;        ///< the last one waits for a vehicle of the chain

  /// Vehicles of the queue that the ego stands in, the one before it first, the head last.
  std::vector<std::string> queue() const;
};

/// Follows the traffic from the ego along its route, then from vehicle to vehicle along their
/// lanes, and along their routes where the demand file holds them:
/// * the stop that the demand orders it to make where it stands;
/// * the nearest vehicle within 20 m ahead of the front bumper;
/// * at a junction within 15 m, its light or stop line;
/// * the last vehicle behind the junction that stands and leaves no room for it;
/// * the nearest vehicle in the junction, or at another of its entries, whose way meets its own.
/// A vehicle faster than 0.5 m/s waits for nothing. Ties by id. Empty without an ego.
WaitChain waitChain(const traffic::TrafficSnapshot& snapshot, const map::RoadNetwork& network,
                    const map::Route& ego_route, const KnownDemand& demand = {});

}  // namespace cdiff::record
