// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "simulation/settling_motion.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "simulation/sumo_conversion.h"

namespace cdiff::simulation {

namespace {

constexpr double kShortestReach = 3.0;     ///< along which the differences decay [m]
constexpr double kReachTime = 0.8;         ///< the same at speed [s]
constexpr double kLargestCurvature = 0.2;  ///< of the vehicle against its lane [1/m]
constexpr double kSettledOffset = 0.01;    ///< [m]
constexpr double kSettledHeading = 0.005;  ///< [rad]

}  // namespace

void SettlingMotion::start(const traffic::VehicleState& sumo, double step) {
  // Straight on from the release at its speed; the differences to SUMO are what has to decay.
  const Eigen::Vector2d front = frontOf(state_.pose(), length_) + state_.velocity() * step;
  const geometry::Pose2d reference{frontOf(sumo.pose(), length_), sumo.heading};
  const Eigen::Vector2d difference = reference.toBody(front);
  along_ = difference.x();
  offset_ = difference.y();
  heading_error_ = core::angleDifference(state_.heading, sumo.heading);
  begun_ = true;
}

void SettlingMotion::decay(double driven, double speed) {
  const double reach = std::max(kShortestReach, kReachTime * speed);
  const double wanted = -offset_ / (reach * reach) - 2.0 * heading_error_ / reach;
  heading_error_ += driven * std::clamp(wanted, -kLargestCurvature, kLargestCurvature);
  offset_ += driven * std::sin(heading_error_);
  along_ -= along_ * std::min(1.0, driven / reach);
}

const traffic::VehicleState& SettlingMotion::advance(const traffic::VehicleState& sumo,
                                                     double step) {
  if (begun_) {
    decay(sumo.speed * step, sumo.speed);
  } else {
    start(sumo, step);
  }
  const geometry::Pose2d reference{frontOf(sumo.pose(), length_), sumo.heading};
  state_ = sumo;
  state_.heading = core::wrapAngle(sumo.heading + heading_error_);
  state_.position = centerBehind(reference.toMap({along_, offset_}), state_.heading, length_);
  return state_;
}

bool SettlingMotion::settled() const {
  return begun_ && std::abs(offset_) < kSettledOffset && std::abs(along_) < kSettledOffset &&
         std::abs(heading_error_) < kSettledHeading;
}

}  // namespace cdiff::simulation
