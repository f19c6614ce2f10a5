// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// How a released vehicle gets from beside the middle of its lane, and askew, into the middle:
/// SUMO's lane model keeps an offset for ever and turns a vehicle at once. Front bumper at path(s)
/// + d n, heading error e: d' = sin e, e' = -d / L^2 - 2 e / L per metre driven (critically
/// damped), |e'| <= 0.2 / m, L = max(3 m, 0.8 s v).
#pragma once

#include "e2e_cdiff/geometry/polyline.h"
#include "e2e_cdiff/simulation/edge_graph.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::simulation {

class SettlingMotion {
 public:
  /// Begins at `state` on `lane`; the path goes on along `way` (edges from that of the lane on).
  SettlingMotion(const EdgeGraph& graph, map::LaneIndex lane, const std::vector<int>& way,
                 const traffic::VehicleState& state, double length);
  /// The state after `step` seconds at `speed`.
  const traffic::VehicleState& advance(double speed, double step);
  const traffic::VehicleState& state() const { return state_; }
  double length() const { return length_; }
  /// In the middle and aligned, or at the end of the path.
  bool settled() const;

 private:
  double headingAt(double arc_length) const;

  geometry::Polyline path_;
  double length_;               ///< of the vehicle [m]
  double arc_length_ = 0.0;     ///< of the front bumper [m]
  double offset_ = 0.0;         ///< to the left [m]
  double heading_error_ = 0.0;  ///< [rad]
  traffic::VehicleState state_;
};

}  // namespace cdiff::simulation
