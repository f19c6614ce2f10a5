// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <vector>

#include "session/driven_vehicles.h"
#include "session/session_setup.h"
#include "simulation/demand_generator.h"

namespace cdiff::session {

/// The vehicles around the ego that the simulator drives: as many as the scenario's generated
/// demand asks for, none where the ego starts (map frame, SI units).
class BackgroundTraffic {
 public:
  /// Both must outlive the object.
  BackgroundTraffic(const SessionSetup& setup, simulation::TrafficSimulator& simulator);

  /// Drives before the ego is there; without demand there is nothing to drive.
  void warmUp();
  /// Removes who could not avoid an ego that suddenly is at `start`.
  void clearStart(const traffic::VehicleState& start);
  /// Removes who is too far from the ego (nullptr: from its start) and adds vehicles of generated
  /// demand; `driven` are not the simulator's.
  void keepDensity(const traffic::Vehicle* ego, const DrivenVehicles& driven);

 private:
  void refill(const traffic::Vehicle* ego, const DrivenVehicles& driven, bool warm_up);
  std::vector<traffic::Vehicle> present(const Eigen::Vector2d& center,
                                        const DrivenVehicles& driven);

  const SessionSetup& setup_;
  simulation::TrafficSimulator& simulator_;
  std::unique_ptr<simulation::DemandGenerator> demand_;  ///< nullptr where it is not generated
};

}  // namespace cdiff::session
