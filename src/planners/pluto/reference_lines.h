// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::planners {

/// A way that a vehicle may take from where it is: poses every 1 m, from abreast of it on (map
/// frame). At least two, at most 121.
struct ReferenceLine {
  std::vector<geometry::Pose2d> poses;

  double length() const { return static_cast<double>(poses.size()) - 1.0; }
};

/// Lines ahead of a vehicle, up to 120 m (Pluto, Cheng et al. 2024, III-B; docs/pluto.md): first
/// its route; then what a depth-first search of the lanes finds, from its lane and the neighbors to
/// the left and to the right, along the edges of the route and from its end straight on. Of these,
/// lines shorter than 0.8 x 120 m are left out where there are longer ones, and lines within 0.5 m
/// of one that is kept; at most `most` stay.
/// `arc_length`: place on the route [m]. A route that ends within 2 m goes straight on for 2 m.
std::vector<ReferenceLine> referenceLines(const map::RoadNetwork& network, const map::Route& route,
                                          double arc_length, const traffic::VehicleState& state,
                                          std::size_t most);

/// The nearest point of a line.
struct LinePlace {
  double arc_length = 0.0;  ///< [m]
  double offset = 0.0;      ///< to the left of it [m]
  double distance = 0.0;    ///< [m]
  double heading = 0.0;     ///< of the line there [rad]
};

LinePlace placeOn(const ReferenceLine& line, const Eigen::Vector2d& point);

}  // namespace cdiff::planners
