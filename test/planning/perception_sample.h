// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "e2e_cdiff/planning/perception.h"

namespace cdiff::test {

/// A vehicle at (10, 2) that heads north with two ways, the second the likelier; an edge of the
/// road; and 2 x 3 cells of 1 m in 0.5 s, the second and the last occupied, from (1, -1.5) on in
/// the frame of an ego that stands at (5, 5) and looks north.
inline planning::Perception samplePerception() {
  planning::Perception perception;
  planning::PerceivedVehicle vehicle;
  vehicle.state = {{10.0, 2.0}, 0.5, 1.5707963267948966, 1.0 / 3.0};
  vehicle.dimensions = {4.0, 2.0, 1.5};
  vehicle.score = 0.75;
  vehicle.forecasts = {{{{10.0, 3.0}, {10.0, 4.0}}, 0.3}, {{{11.0, 3.0}, {12.0, 3.5}}, 0.6}};
  perception.vehicles = {vehicle};
  perception.lines = {{"edge", {{0.0, -2.0}, {10.0, -2.0}, {20.0, -1.0}}, 0.9}};
  planning::PerceivedOccupancy occupancy;
  occupancy.time = 0.5;
  occupancy.frame = {{5.0, 5.0}, 1.5707963267948966};
  occupancy.origin = {1.0, -1.5};
  occupancy.rows = 2;
  occupancy.columns = 3;
  occupancy.probability = {0.0F, 0.9F, 0.5F, 0.1F, 0.2F, 0.6F};
  perception.occupancy = {occupancy};
  return perception;
}

}  // namespace cdiff::test
