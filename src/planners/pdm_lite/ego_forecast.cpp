// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/pdm_lite/ego_forecast.h"

#include "planners/pdm_lite/longitudinal_controller.h"
#include "planning/motion_forecast.h"

namespace cdiff::planners {

double steerAlong(const map::Route& route, const traffic::VehicleState& state,
                  DriverState& driver) {
  driver.follower.update(route, state.position);
  const double aim = driver.follower.arcLength() + lookAheadDistance(state.speed);
  return driver.lateral.steer(state.pose(), planning::extendedPositionAt(route, aim));
}

std::vector<planning::RolloutPoint> forecastEgo(const traffic::VehicleState& start,
                                                const map::Route& route, DriverState driver,
                                                double target_speed,
                                                const dynamics::BicycleModel& model,
                                                std::size_t steps) {
  std::vector<planning::RolloutPoint> points;
  points.reserve(steps);
  traffic::VehicleState state = start;
  for (std::size_t i = 0; i < steps; ++i) {
    traffic::ControlAction action;
    action.steer = steerAlong(route, state, driver);
    action.throttle = forecastThrottle(state.speed, target_speed);
    state = model.step(state, action, planning::kForecastStep);
    points.push_back({state, action});
  }
  return points;
}

}  // namespace cdiff::planners
