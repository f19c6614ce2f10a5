// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planning/route_forecast.h"

#include <algorithm>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/traffic/rollout.h"
#include "planning/route_follower.h"

namespace cdiff::planning {

std::vector<traffic::VehicleState> forecastAlongRoute(const traffic::Vehicle& vehicle,
                                                      const map::Route& route, double arc_length,
                                                      std::size_t steps) {
  constexpr double kHeldAcceleration = 1.0;  // [s]
  const auto normal = [&](double s) {
    const double heading = route.path().headingAt(std::clamp(s, 0.0, route.length()));
    return geometry::direction(heading + 0.5 * core::kPi);
  };
  const double offset =
      normal(arc_length).dot(vehicle.state.position - extendedPositionAt(route, arc_length));
  std::vector<traffic::VehicleState> states;
  traffic::VehicleState state = vehicle.state;
  for (std::size_t i = 1; i <= steps; ++i) {
    const double time = static_cast<double>(i) * traffic::kRolloutStep;
    const double held = std::min(time, kHeldAcceleration);
    state.speed = std::max(0.0, vehicle.state.speed + held * vehicle.acceleration);
    arc_length += state.speed * traffic::kRolloutStep;
    state.position = extendedPositionAt(route, arc_length) + offset * normal(arc_length);
    state.heading = route.path().headingAt(std::clamp(arc_length, 0.0, route.length()));
    states.push_back(state);
  }
  return states;
}

}  // namespace cdiff::planning
