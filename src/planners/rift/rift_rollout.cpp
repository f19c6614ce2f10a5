// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/rift/rift_rollout.h"

#include <cmath>

namespace cdiff::planners {
namespace {

constexpr int kTicksOfStep = 2;

/// Where a vehicle is in a rollout.
struct Motion : planning::PlanFollower {
  double heading = 0.0;  ///< of its direction
};

}  // namespace

RiftPlan::RiftPlan(const PlutoTrajectory& candidate, double heading) {
  const Eigen::Vector2d forward = geometry::direction(heading);
  const Eigen::Vector2d left = geometry::leftNormal(forward);
  const Eigen::Matrix<double, kPlutoSteps, 4> rows = candidate.leftCols<4>().cast<double>();
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    places[i] = rows(row, 0) * forward + rows(row, 1) * left;
    if (i < directions.size()) directions[i] = rows(row, 2) * forward + rows(row, 3) * left;
  }
}

RiftDriver::RiftDriver(const dynamics::BicycleModelOptions& vehicle,
                       const planning::PlanTrackerOptions& tracker)
    : model_(vehicle), tracker_(tracker) {
  tracker_.validate();
}

namespace {

/// One tick of the bicycle model; `slip`: cos and sin of the slip angle.
void moveOn(const dynamics::BicycleModel& model, const traffic::ControlAction& action,
            const Eigen::Vector2d& slip, Motion& motion) {
  const double distance = motion.speed * dynamics::BicycleModel::kTick;
  const Eigen::Vector2d& along = motion.direction;
  motion.position += distance * (slip.x() * along + slip.y() * geometry::leftNormal(along));
  motion.heading += distance * slip.y() / model.options().rear_length;
  motion.direction = geometry::direction(motion.heading);
  motion.speed = model.nextSpeed(motion.speed, action);
}

/// Cos and sin of atan(tangent).
Eigen::Vector2d directionOfTangent(double tangent) {
  const double cosine = 1.0 / std::sqrt(1.0 + tangent * tangent);
  return {cosine, tangent * cosine};
}

}  // namespace

RiftRollout RiftDriver::drive(const RiftPlan& plan, double heading, double speed) const {
  const dynamics::BicycleModelOptions& vehicle = model_.options();
  const double ratio = vehicle.rear_length / (vehicle.rear_length + vehicle.front_length);
  planning::PlanTracker tracker(tracker_);
  RiftRollout rollout;
  Motion motion;
  motion.heading = heading;
  motion.direction = geometry::direction(heading);
  motion.speed = speed;
  rollout.heading[0] = heading;
  rollout.speed[0] = speed;
  for (std::size_t step = 0; step < kRiftSteps; ++step) {
    const traffic::ControlAction action =
        tracker.track(motion, {plan.places.data() + step, plan.places.size() - step});
    const Eigen::Vector2d slip =
        directionOfTangent(ratio * std::tan(vehicle.steering_gain * action.steer));
    for (int tick = 0; tick < kTicksOfStep; ++tick) moveOn(model_, action, slip, motion);
    rollout.x[step + 1] = motion.position.x();
    rollout.y[step + 1] = motion.position.y();
    rollout.heading[step + 1] = motion.heading;
    rollout.speed[step + 1] = motion.speed;
  }
  return rollout;
}

}  // namespace cdiff::planners
