// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/pdm_lite/forecasts.h"

#include <algorithm>

#include "planners/pdm_lite/lateral_controller.h"
#include "planners/pdm_lite/longitudinal_controller.h"
#include "planning/surrounding_vehicles.h"

namespace cdiff::planners {
namespace {

constexpr double kEgoFast = 5.0;  // [m/s]
constexpr double kEgoLengthFactor = 1.3;
constexpr double kEgoWidthFactor = 1.2;
constexpr double kOtherSlow = 1.0;  // [m/s]
constexpr double kOtherLengthFactor = 1.2;
constexpr double kOtherLengthFactorLaneChange = 2.0;
constexpr double kOtherWidthFactor = 1.3;

geometry::OrientedBox grown(const traffic::VehicleState& state,
                            const traffic::VehicleDimensions& dimensions, double length_factor,
                            double width_factor) {
  return {state.position, state.heading, length_factor * dimensions.length,
          width_factor * dimensions.width};
}

/// Cheap test that spares the separating axes: circles around both boxes.
bool mayOverlap(const geometry::OrientedBox& first, const geometry::OrientedBox& second) {
  const double reach = 0.5 * (first.length + first.width + second.length + second.width);
  return (first.center - second.center).squaredNorm() <= reach * reach;
}

}  // namespace

std::vector<geometry::OrientedBox> egoBoxes(const traffic::Vehicle& ego,
                                            const std::vector<planning::RolloutPoint>& forecast) {
  const bool fast = ego.state.speed >= kEgoFast;
  std::vector<geometry::OrientedBox> boxes;
  boxes.reserve(forecast.size());
  for (const planning::RolloutPoint& point : forecast) {
    boxes.push_back(grown(point.state, ego.dimensions, fast ? kEgoLengthFactor : 1.0,
                          fast ? kEgoWidthFactor : 1.0));
  }
  return boxes;
}

std::vector<geometry::OrientedBox> otherBoxes(const traffic::VehicleDimensions& dimensions,
                                              const std::vector<traffic::VehicleState>& forecast,
                                              std::size_t steps, bool near_lane_change) {
  const double length_factor = near_lane_change ? kOtherLengthFactorLaneChange : kOtherLengthFactor;
  const std::size_t count = std::min(steps, forecast.size());
  std::vector<geometry::OrientedBox> boxes;
  boxes.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const bool slow = forecast[i].speed < kOtherSlow;
    const double share = static_cast<double>(i) / static_cast<double>(count);
    const double width_factor = std::max(1.0, kOtherWidthFactor * share);
    boxes.push_back(
        grown(forecast[i], dimensions, slow ? 1.0 : length_factor, slow ? 1.0 : width_factor));
  }
  return boxes;
}

std::optional<std::size_t> meet(const std::vector<geometry::OrientedBox>& first,
                                const std::vector<geometry::OrientedBox>& second,
                                std::size_t steps) {
  const std::size_t count = std::min({steps, first.size(), second.size()});
  for (std::size_t i = 0; i < count; ++i) {
    if (mayOverlap(first[i], second[i]) && geometry::overlap(first[i], second[i])) return i;
  }
  return std::nullopt;
}

double steerAlong(const map::Route& route, const traffic::VehicleState& state,
                  DriverState& driver) {
  driver.follower.update(route, state.position);
  const double aim = driver.follower.arcLength() + lookAheadDistance(state.speed);
  return driver.lateral.steer(state.pose(), route.path().extendedPoseAt(aim).position);
}

std::vector<planning::RolloutPoint> forecastEgo(const traffic::VehicleState& start,
                                                const map::Route& route, DriverState driver,
                                                double target_speed,
                                                const dynamics::BicycleModel& model,
                                                const EgoHorizon& horizon) {
  std::vector<planning::RolloutPoint> points;
  points.reserve(horizon.steps);
  traffic::VehicleState state = start;
  for (std::size_t i = 0; i < horizon.steps; ++i) {
    traffic::ControlAction action;
    for (int decision = 0; decision < horizon.decisions; ++decision) {
      action.steer = steerAlong(route, state, driver);
      action.throttle = forecastThrottle(state.speed, target_speed);
      state = model.step(state, action, planning::kForecastStep / horizon.decisions);
    }
    points.push_back({state, action});
  }
  return points;
}

}  // namespace cdiff::planners
