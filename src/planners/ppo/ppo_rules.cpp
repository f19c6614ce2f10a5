// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/ppo/ppo_rules.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "e2e_cdiff/core/angle.h"

namespace cdiff::planners {
namespace {

constexpr double kSearchRadius = 60.0;        // [m]
constexpr double kLargestAcceleration = 3.0;  // [m/s^2] of an action of 1
constexpr double kLargestSteer = 0.3;         // of an action of 1
constexpr double kFullBrake = 8.0;            // [m/s^2] that brake 1 stands for
constexpr double kLargestProgress = 1.0;      // [m] rewarded per decision
constexpr double kTerminalReward = 15.0;

void putVehicle(const traffic::Vehicle& vehicle, const geometry::Pose2d& frame, std::size_t row,
                PpoObservation& observation) {
  const Eigen::Vector2d place = frame.toBody(vehicle.state.position);
  const std::array<double, kPpoColumns> values = {
      place.x(),
      place.y(),
      vehicle.dimensions.length,
      vehicle.dimensions.width,
      core::angleDifference(vehicle.state.heading, frame.heading),
      vehicle.state.speed};
  for (std::size_t i = 0; i < kPpoColumns; ++i)
    observation[row * kPpoColumns + i] = static_cast<float>(values[i]);
}

void putGoal(const PpoGoal& goal, const traffic::VehicleState& cbv, PpoObservation& observation) {
  const Eigen::Vector2d place = cbv.pose().toBody(goal.position);
  const std::array<double, kPpoColumns> values = {place.x(),
                                                  place.y(),
                                                  kPpoGoalRadius,
                                                  kPpoGoalRadius,
                                                  core::angleDifference(goal.heading, cbv.heading),
                                                  ppoGoalDistance(goal, cbv)};
  for (std::size_t i = 0; i < kPpoColumns; ++i)
    observation[kPpoGoal * kPpoColumns + i] = static_cast<float>(values[i]);
}

/// The nearest vehicle on the CBV's level that is neither the CBV nor the ego; the first of equals.
const traffic::Vehicle* nearestOther(const traffic::TrafficSnapshot& snapshot,
                                     const traffic::Vehicle& ego, const traffic::Vehicle& cbv) {
  const traffic::Vehicle* nearest = nullptr;
  double distance = kSearchRadius;
  for (const traffic::Vehicle& other : snapshot.vehicles) {
    if (other.id == cbv.id || other.id == ego.id || traffic::onDifferentLevels(other, cbv))
      continue;
    const double away = (other.state.position - cbv.state.position).norm();
    if (!(away < distance)) continue;
    nearest = &other;
    distance = away;
  }
  return nearest;
}

}  // namespace

PpoGoal ppoGoal(const map::Route& ego_route, double ego_arc_length) {
  constexpr int kIndex = kPpoLocalRoutePoints / 3;
  const double place = ego_arc_length + kPpoLocalRouteStart + kIndex * kPpoLocalRouteSpacing;
  const geometry::Pose2d pose = ego_route.path().extendedPoseAt(place);
  return {pose.position, pose.heading};
}

double ppoGoalDistance(const PpoGoal& goal, const traffic::VehicleState& cbv) {
  return (goal.position - cbv.position).norm();
}

PpoObservation ppoObservation(const traffic::TrafficSnapshot& snapshot, const traffic::Vehicle& ego,
                              const traffic::Vehicle& cbv, const PpoGoal& goal) {
  PpoObservation observation{};
  const geometry::Pose2d frame = cbv.state.pose();
  putVehicle(cbv, frame, kPpoSelf, observation);
  putVehicle(ego, frame, kPpoEgo, observation);
  const traffic::Vehicle* nearest = nearestOther(snapshot, ego, cbv);
  if (nearest != nullptr) putVehicle(*nearest, frame, kPpoNearest, observation);
  putGoal(goal, cbv.state, observation);
  return observation;
}

std::string ppoNotFinite(const PpoObservation& observation) {
  static const char* const kColumns[] = {"x", "y", "length", "width", "heading", "speed"};
  static const char* const kRows[] = {"CBV", "ego", "nearest vehicle", "goal"};
  for (std::size_t i = 0; i < kPpoInputs; ++i) {
    if (!std::isfinite(observation[i]))
      return std::string(kColumns[i % kPpoColumns]) + " of the " + kRows[i / kPpoColumns];
  }
  return "";
}

traffic::ControlAction ppoCommand(const PpoAction& action) {
  if (!std::isfinite(action[0]) || !std::isfinite(action[1]))
    throw std::invalid_argument("PPO: the action is not finite");
  const double acceleration = std::clamp(kLargestAcceleration * static_cast<double>(action[0]),
                                         -kLargestAcceleration, kLargestAcceleration);
  traffic::ControlAction command;
  command.steer =
      std::clamp(kLargestSteer * static_cast<double>(action[1]), -kLargestSteer, kLargestSteer);
  if (acceleration > 0.0) {
    command.throttle = acceleration / kLargestAcceleration;
  } else {
    command.brake = -acceleration / kFullBrake;
  }
  return command;
}

double ppoReward(const PpoOutcome& outcome) {
  const double progress = outcome.distance_before - outcome.distance_now;
  double reward = std::clamp(progress, -kLargestProgress, kLargestProgress);
  if (outcome.touched_other) reward -= kTerminalReward;
  if (outcome.reached_goal) reward += kTerminalReward;
  return reward;
}

}  // namespace cdiff::planners
