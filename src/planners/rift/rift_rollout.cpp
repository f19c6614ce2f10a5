// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/rift/rift_rollout.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "e2e_cdiff/core/angle.h"

namespace cdiff::planners {
namespace {

constexpr std::size_t kStepsPerSecond = 10;  // steps
constexpr std::size_t kRolloutAims = 3;      // places 1, 2 and 3 s ahead
constexpr double kRolloutStandstill = 0.01;  // [m/s] slower than this it does not steer
constexpr int kTicksOfStep = 2;

/// planning::WindowedPid without allocation: the sum of the window is kept.
class RingPid {
 public:
  RingPid(double kp, double ki, double kd, std::int64_t window)
      : kp_(kp), ki_(ki), kd_(kd), errors_(static_cast<std::size_t>(window), 0.0) {}

  double update(double error) {
    const double change = error - last_;
    sum_ += error - errors_[next_];
    errors_[next_] = error;
    next_ = next_ + 1 == errors_.size() ? 0 : next_ + 1;
    last_ = error;
    return kp_ * error + ki_ * sum_ / static_cast<double>(errors_.size()) + kd_ * change;
  }

 private:
  double kp_;
  double ki_;
  double kd_;
  std::vector<double> errors_;
  std::size_t next_ = 0;
  double sum_ = 0.0;
  double last_ = 0.0;
};

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

/// The two PIDs of one rollout.
class RolloutPids {
 public:
  explicit RolloutPids(const TrajectoryTrackerOptions& options)
      : options_(options),
        turn_(options.turn_kp, options.turn_ki, options.turn_kd, options.window),
        speed_(options.speed_kp, options.speed_ki, options.speed_kd, options.window) {}

  /// `aims`: the plan 1, 2 and 3 s ahead.
  traffic::ControlAction track(const Motion& motion,
                               const std::array<Eigen::Vector2d, kRolloutAims>& aims) {
    double length = 0.0;
    Eigen::Vector2d last = motion.place;
    for (const Eigen::Vector2d& aim : aims) {
      length += (aim - last).norm();
      last = aim;
    }
    const double desired = length / static_cast<double>(kRolloutAims);
    const bool brake =
        desired < options_.brake_speed || motion.speed > options_.brake_ratio * desired;
    const bool steers = !brake && motion.speed >= kRolloutStandstill;
    const double turn = turn_.update(steers ? turnError(motion, aims) : 0.0);
    const double drive =
        speed_.update(std::clamp(desired - motion.speed, 0.0, options_.speed_error_limit));
    traffic::ControlAction action;
    action.steer = std::clamp(turn, -1.0, 1.0);
    action.throttle = brake ? 0.0 : std::clamp(drive, 0.0, options_.max_throttle);
    action.brake = brake ? 1.0 : 0.0;
    return action;
  }

 private:
  double turnError(const Motion& motion,
                   const std::array<Eigen::Vector2d, kRolloutAims>& aims) const {
    const double look_ahead =
        std::clamp(options_.look_ahead_time * motion.speed + options_.look_ahead_distance,
                   options_.look_ahead_minimum, options_.look_ahead_maximum);
    Eigen::Vector2d best = Eigen::Vector2d::Zero();
    double nearest = 0.0;
    for (std::size_t i = 0; i < kRolloutAims; ++i) {
      const Eigen::Vector2d away = aims[i] - motion.place;
      const double off = std::abs(away.norm() - look_ahead);
      if (i > 0 && off >= nearest) continue;
      nearest = off;
      best = away;
    }
    const double across = geometry::cross(motion.direction, best);
    return std::atan2(across, motion.direction.dot(best)) / (0.5 * core::kPi);
  }

  const TrajectoryTrackerOptions& options_;
  RingPid turn_;
  RingPid speed_;
};

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
  RolloutPids pids(tracker_);
  RiftRollout rollout;
  Motion motion{Eigen::Vector2d::Zero(), heading, geometry::direction(heading), speed};
  rollout.heading[0] = heading;
  rollout.speed[0] = speed;
  for (std::size_t step = 0; step < kRiftSteps; ++step) {
    std::array<Eigen::Vector2d, kRolloutAims> aims;
    for (std::size_t i = 0; i < kRolloutAims; ++i)
      aims[i] = plan.places[step + (i + 1) * kStepsPerSecond - 1];
    const traffic::ControlAction action = pids.track(motion, aims);
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
