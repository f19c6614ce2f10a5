// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A straight road for tests: one lane of 3.2 m along y = 0 from x = 0 to 300 m, a route of 100 m
/// on it, and snapshots.
#pragma once

#include <string>
#include <vector>

#include "e2e_cdiff/map/drivable_area.h"
#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::test {

inline map::RoadNetwork straightRoad() {
  return map::RoadNetwork::fromText(R"(<net version="1.9">
    <location netOffset="0.00,0.00" convBoundary="0,0,300,0" origBoundary="0,0,300,0" projParameter="!"/>
    <edge id="road" from="west" to="east" priority="1">
      <lane id="road_0" index="0" speed="13.89" length="300.00" width="3.20" shape="0.00,0.00 300.00,0.00"/>
    </edge>
    <junction id="west" type="dead_end" x="0.00" y="0.00" incLanes="" intLanes="" shape="0.00,1.60 0.00,-1.60"/>
    <junction id="east" type="dead_end" x="300.00" y="0.00" incLanes="road_0" intLanes="" shape="300.00,-1.60 300.00,1.60"/>
  </net>)",
                                    "straight road");
}

/// The road with its drivable area and the route from x = 0 to 100 m.
struct StraightRoad {
  map::RoadNetwork network = straightRoad();
  map::DrivableArea drivable_area{network};
  map::Route route = makeRoute(network);

  static map::Route makeRoute(const map::RoadNetwork& network) {
    std::vector<Eigen::Vector3d> points;
    for (int x = 0; x <= 100; ++x) points.emplace_back(x, 0.0, 0.0);
    return map::Route(network, points, std::vector<map::LaneIndex>(points.size(), 0));
  }
};

/// 4.8 m x 1.8 m, along +x.
inline traffic::Vehicle vehicle(const std::string& id, traffic::VehicleRole role, double x,
                                double y, double speed) {
  traffic::Vehicle vehicle;
  vehicle.id = id;
  vehicle.role = role;
  vehicle.cbv_slot = role == traffic::VehicleRole::kCbv ? 0 : -1;
  vehicle.state.position = {x, y};
  vehicle.state.speed = speed;
  vehicle.dimensions = {4.8, 1.8, 1.5};
  return vehicle;
}

inline traffic::Vehicle ego(double x, double y, double speed) {
  return vehicle("ego", traffic::VehicleRole::kEgo, x, y, speed);
}
inline traffic::Vehicle cbv(const std::string& id, double x, double y, double speed) {
  return vehicle(id, traffic::VehicleRole::kCbv, x, y, speed);
}
inline traffic::Vehicle background(const std::string& id, double x, double y, double speed) {
  return vehicle(id, traffic::VehicleRole::kBackground, x, y, speed);
}

/// Tick n; even ticks are decision ticks.
inline traffic::TrafficSnapshot snapshot(std::uint64_t tick,
                                         std::vector<traffic::Vehicle> vehicles) {
  traffic::TrafficSnapshot snapshot;
  snapshot.tick = tick;
  snapshot.time = 0.05 * static_cast<double>(tick);
  snapshot.decision_tick = tick % 2 == 0;
  snapshot.vehicles = std::move(vehicles);
  return snapshot;
}

}  // namespace cdiff::test
