// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/two_stage_pid/pdm_lite_tracker.h"

#include "planners/pdm_lite/longitudinal_controller.h"
#include "planning/plan_tracker.h"

namespace cdiff::planners {

Eigen::Vector2d pointAlong(const Eigen::MatrixX2d& places, double distance) {
  Eigen::Vector2d last = Eigen::Vector2d::Zero();
  double left = distance;
  for (const auto& row : places.rowwise()) {
    const Eigen::Vector2d place = row.transpose();
    const double length = (place - last).norm();
    if (length > 0.0 && length >= left) return last + (place - last) * (left / length);
    left -= length;
    last = place;
  }
  return last;
}

traffic::ControlAction PdmLiteTracker::track(double speed, const Eigen::MatrixX2d& places) {
  using planning::PlanTracker;
  const double desired = planning::desiredSpeed(places, speed_horizon_);
  const Eigen::Vector2d aim = pointAlong(places, lookAheadDistance(speed));
  const bool steers = speed >= PlanTracker::kStandstill && aim.norm() >= PlanTracker::kNearestAim;
  const PedalCommand pedal = pedals(speed, desired);
  traffic::ControlAction action;
  action.steer = lateral_.steer(geometry::Pose2d(), steers ? aim : Eigen::Vector2d::UnitX().eval());
  action.throttle = pedal.throttle;
  action.brake = pedal.brake ? 1.0 : 0.0;
  return action;
}

}  // namespace cdiff::planners
