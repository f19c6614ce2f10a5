// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::simulation {

/// How a released vehicle gets from where it was to where SUMO has it, in the middle of its lane
/// and aligned: front bumper at SUMO's + a along + d to the left, heading SUMO's + e. Per meter
/// driven d' = sin e, e' = -d / L^2 - 2 e / L (critically damped, |e'| <= 0.2 / m), a' = -a / L, L
/// = max(3 m, 0.8 s v).
class SettlingMotion {
 public:
  /// Begins with the state at the release of a vehicle of this length [m].
  SettlingMotion(const traffic::VehicleState& released, double length)
      : state_(released), length_(length) {}
  /// Where the vehicle is `step` seconds later, when SUMO has it at `sumo`.
  const traffic::VehicleState& advance(const traffic::VehicleState& sumo, double step);
  /// Where SUMO has it.
  bool settled() const;

 private:
  void start(const traffic::VehicleState& sumo, double step);
  void decay(double driven, double speed);

  traffic::VehicleState state_;
  double length_;
  bool begun_ = false;
  double along_ = 0.0;          ///< [m]
  double offset_ = 0.0;         ///< to the left [m]
  double heading_error_ = 0.0;  ///< [rad]
};

}  // namespace cdiff::simulation
