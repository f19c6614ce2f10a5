// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/rift/rift_rollout.h"

#include <cmath>

namespace cdiff::planners {
namespace {

constexpr std::size_t kStepsPerSecond = 10;  // steps
constexpr std::size_t kRolloutAims = 3;      // places 1, 2 and 3 s ahead
constexpr int kTicksOfStep = 2;

/// Where a vehicle is in a rollout.
struct Motion {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  double heading = 0.0;
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();  ///< of the heading
  double speed = 0.0;
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

namespace {

/// The plan 1, 2 and 3 s ahead.
using RolloutPlaces = std::array<Eigen::Vector2d, kRolloutAims>;

double meanSpeedOf(const Motion& motion, const RolloutPlaces& aims) {
  double length = 0.0;
  Eigen::Vector2d last = motion.place;
  for (const Eigen::Vector2d& aim : aims) {
    length += (aim - last).norm();
    last = aim;
  }
  return length / static_cast<double>(kRolloutAims);
}

/// Toward the place whose distance is nearest to the look-ahead.
double turnErrorOf(const Motion& motion, const RolloutPlaces& aims, double look_ahead) {
  Eigen::Vector2d best = Eigen::Vector2d::Zero();
  double nearest = 0.0;
  for (std::size_t i = 0; i < kRolloutAims; ++i) {
    const Eigen::Vector2d away = aims[i] - motion.place;
    const double off = std::abs(away.norm() - look_ahead);
    if (i > 0 && off >= nearest) continue;
    nearest = off;
    best = away;
  }
  return planning::turnErrorToward(
      {motion.direction.dot(best), geometry::cross(motion.direction, best)});
}

traffic::ControlAction actionOf(const TrajectoryTrackerOptions& tracker, const Motion& motion,
                                const RolloutPlaces& aims, planning::PlanPids& pids) {
  const double desired = meanSpeedOf(motion, aims);
  const bool steers =
      !pids.brakes(motion.speed, desired) && motion.speed >= TrajectoryTracker::kStandstill;
  const double turn_error =
      steers ? turnErrorOf(motion, aims, tracker.lookAhead(motion.speed)) : 0.0;
  return pids.track(motion.speed, desired, turn_error);
}

}  // namespace

RiftDriver::RiftDriver(const dynamics::BicycleModelOptions& vehicle,
                       const TrajectoryTrackerOptions& tracker)
    : model_(vehicle), tracker_(tracker) {
  tracker_.validate();
}

namespace {

/// One tick of the bicycle model; `slip`: cos and sin of the slip angle.
void moveOn(const dynamics::BicycleModel& model, const traffic::ControlAction& action,
            const Eigen::Vector2d& slip, Motion& motion) {
  const double distance = motion.speed * dynamics::BicycleModel::kTick;
  const Eigen::Vector2d& along = motion.direction;
  motion.place += distance * (slip.x() * along + slip.y() * geometry::leftNormal(along));
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
  planning::PlanPids pids(tracker_.pids);
  RiftRollout rollout;
  Motion motion{Eigen::Vector2d::Zero(), heading, geometry::direction(heading), speed};
  rollout.heading[0] = heading;
  rollout.speed[0] = speed;
  for (std::size_t step = 0; step < kRiftSteps; ++step) {
    RolloutPlaces aims;
    for (std::size_t i = 0; i < kRolloutAims; ++i)
      aims[i] = plan.places[step + (i + 1) * kStepsPerSecond - 1];
    const traffic::ControlAction action = actionOf(tracker_, motion, aims, pids);
    const Eigen::Vector2d slip =
        directionOfTangent(ratio * std::tan(vehicle.steering_gain * action.steer));
    for (int tick = 0; tick < kTicksOfStep; ++tick) moveOn(model_, action, slip, motion);
    rollout.x[step + 1] = motion.place.x();
    rollout.y[step + 1] = motion.place.y();
    rollout.heading[step + 1] = motion.heading;
    rollout.speed[step + 1] = motion.speed;
  }
  return rollout;
}

}  // namespace cdiff::planners
