// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "reference_driver/driven_path.h"
#include "reference_driver/reference_driver.h"

namespace cdiff::reference_driver {

// Drives a reference driver through the time ahead, among vehicles whose motion is given (map
// frame, SI units). The choice of plans in mode challenging and the ego planner careful_driver use
// it.

/// Another vehicle over the time ahead: where it is 0, 0.1, 0.2 ... s from now (map frame).
struct ForeseenVehicle {
  std::uint64_t id = 0;  ///< hash of its id
  traffic::VehicleDimensions dimensions;
  std::vector<traffic::VehicleState> states;  ///< the last one is kept where there are too few
};

/// How a reference driver is driven ahead.
struct DriveTerms {
  double duration = 4.2;   ///< [s]
  double clearance = 0.3;  ///< a box nearer than this counts as touched [m]
  double top_speed = 8.0;  ///< it accelerates no further [m/s]
};

/// How a driver's course ends: with a contact or without.
struct DriveOutcome {
  std::optional<double> contact_time;  ///< first [s] from now
  std::size_t struck = 0;              ///< index of the vehicle
  OwnMotion at_contact;                ///< the driver then, or at the end
  std::optional<double> brake_time;    ///< it brakes first [s] from now
};

/// Step of driveAhead, and between the states of foreseen vehicles [s].
inline constexpr double kForeseenStep = 0.1;

/// Moves on for `duration` [s] with a mean acceleration [m/s^2], up to `top_speed` and not back.
void advance(OwnMotion& own, double acceleration, double top_speed, double duration);

/// Drives `driver` from `start` along its path among vehicles whose motion is given. It sees them
/// as they are at each step. Until it brakes it keeps its speed, and a positive acceleration for
/// one second; it never drives on before the end.
DriveOutcome driveAhead(ReferenceDriver& driver, const OwnMotion& start, const DrivenPath& path,
                        const std::vector<ForeseenVehicle>& others, const DriveTerms& terms);

/// The vehicles at a step (0: now) as the driver sees them; `hints` are the path's, one a vehicle.
std::vector<SeenVehicle> seeAt(const DrivenPath& path, const std::vector<ForeseenVehicle>& others,
                               std::size_t step, std::vector<std::optional<std::size_t>>& hints);

}  // namespace cdiff::reference_driver
