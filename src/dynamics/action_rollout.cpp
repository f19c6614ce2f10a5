// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "dynamics/action_rollout.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::dynamics {
namespace {

constexpr double kLeastBrake = 0.05;  // below it the sampled brake is noise around none

}  // namespace

traffic::ControlAction executableAction(const traffic::Rollout& rollout, Eigen::Index row) {
  traffic::ControlAction action;
  action.throttle = std::clamp(rollout(row, traffic::kRolloutThrottle), 0.0, 1.0);
  action.steer = std::clamp(rollout(row, traffic::kRolloutSteer), -1.0, 1.0);
  action.brake = std::clamp(rollout(row, traffic::kRolloutBrake), 0.0, 1.0);
  if (action.brake < kLeastBrake || action.brake < action.throttle)
    action.brake = 0.0;
  else
    action.throttle = 0.0;
  return action;
}

void makeExecutable(traffic::Rollout& rollout) {
  for (Eigen::Index row = 0; row < rollout.rows(); ++row) {
    const traffic::ControlAction action = executableAction(rollout, row);
    rollout.row(row).tail<traffic::kActionColumns>() << action.throttle, action.steer, action.brake;
  }
}

namespace {

using traffic::ControlAction;
using traffic::Rollout;

constexpr int kTicksPerRow = 2;
static_assert(kTicksPerRow * BicycleModel::kTick == traffic::kRolloutStep, "a row is two ticks");

struct State {
  double x = 0.0;
  double y = 0.0;
  double heading = 0.0;
  double speed = 0.0;
};

/// dJ/d(state), and what a row adds to dJ/d(action).
using StateAdjoint = State;
struct ActionAdjoint {
  double throttle = 0.0;
  double slip = 0.0;
  double brake = 0.0;
};

ControlAction clampedAction(const Rollout& rollout, Eigen::Index row) {
  return {std::clamp(rollout(row, traffic::kRolloutThrottle), 0.0, 1.0),
          std::clamp(rollout(row, traffic::kRolloutSteer), -1.0, 1.0),
          std::clamp(rollout(row, traffic::kRolloutBrake), 0.0, 1.0)};
}

/// State at the start of a row.
State stateBefore(double initial_speed, const Rollout& rollout, Eigen::Index row) {
  if (row == 0) return {0.0, 0.0, 0.0, initial_speed};
  return {rollout(row - 1, traffic::kRolloutX), rollout(row - 1, traffic::kRolloutY),
          rollout(row - 1, traffic::kRolloutHeading), rollout(row - 1, traffic::kRolloutSpeed)};
}

/// Moves a state by one tick without its speed, in the order of operations of BicycleModel::step.
void move(State& state, double slip, double turn, double rear_length) {
  const double distance = state.speed * BicycleModel::kTick;
  state.x += distance * std::cos(state.heading + slip);
  state.y += distance * std::sin(state.heading + slip);
  state.heading += state.speed / rear_length * turn * BicycleModel::kTick;
}

/// What a tick of a row means for the state before it.
struct TickAdjoint {
  double slip;
  double turn;  ///< sin(slip)
  double grip;  ///< cos(slip)
  double rear_length;

  void backward(double heading, double speed, const SpeedResponse& response, StateAdjoint& state,
                ActionAdjoint& action) const {
    const double distance = speed * BicycleModel::kTick;
    const double cosine = std::cos(heading + slip);
    const double sine = std::sin(heading + slip);
    const double sideways = distance * (state.y * cosine - state.x * sine);
    action.throttle += response.by_throttle * state.speed;
    action.brake += response.by_brake * state.speed;
    action.slip += sideways + state.heading * distance / rear_length * grip;
    state.speed = response.by_speed * state.speed +
                  BicycleModel::kTick * (state.x * cosine + state.y * sine) +
                  state.heading * turn / rear_length * BicycleModel::kTick;
    state.heading += sideways;
  }
};

/// Takes dJ/d(state) from the end of a row to its start; gives what the row's action adds.
ActionAdjoint backwardRow(const BicycleModel& model, const State& start,
                          const ControlAction& action, double slip, StateAdjoint& adjoint) {
  const double rear_length = model.options().rear_length;
  const TickAdjoint tick{slip, std::sin(slip), std::cos(slip), rear_length};
  const double middle_heading =
      start.heading + start.speed / rear_length * tick.turn * BicycleModel::kTick;
  const SpeedResponse first = model.speedResponse(start.speed, action);
  const SpeedResponse second = model.speedResponse(first.speed, action);
  ActionAdjoint sum;
  tick.backward(middle_heading, first.speed, second, adjoint, sum);
  tick.backward(start.heading, start.speed, first, adjoint, sum);
  return sum;
}

/// A derivative that may be followed downhill from an action within [low, high].
double within(double derivative, double action, double low, double high) {
  const bool out = (action <= low && derivative > 0.0) || (action >= high && derivative < 0.0);
  return out ? 0.0 : derivative;
}

}  // namespace

ActionRollout::ActionRollout(const BicycleModelOptions& options, ThrottleResponse response)
    : model_(options), response_(response) {}

void ActionRollout::rollOut(double initial_speed, Rollout& rollout) const {
  State state{0.0, 0.0, 0.0, initial_speed};
  const double rear_length = model_.options().rear_length;
  for (Eigen::Index row = 0; row < rollout.rows(); ++row) {
    const ControlAction action = commanded(state.speed, clampedAction(rollout, row));
    const double slip = model_.slip(action.steer);
    const double turn = std::sin(slip);
    for (int tick = 0; tick < kTicksPerRow; ++tick) {
      move(state, slip, turn, rear_length);
      state.speed = model_.nextSpeed(state.speed, action);
    }
    rollout(row, traffic::kRolloutX) = state.x;
    rollout(row, traffic::kRolloutY) = state.y;
    rollout(row, traffic::kRolloutHeading) = state.heading;
    rollout(row, traffic::kRolloutSpeed) = state.speed;
  }
}

void ActionRollout::backward(double initial_speed, const Rollout& rollout,
                             Rollout& gradient) const {
  using traffic::kRolloutBrake, traffic::kRolloutSteer, traffic::kRolloutThrottle;
  StateAdjoint adjoint;
  for (Eigen::Index row = rollout.rows() - 1; row >= 0; --row) {
    adjoint.x += gradient(row, traffic::kRolloutX);
    adjoint.y += gradient(row, traffic::kRolloutY);
    adjoint.heading += gradient(row, traffic::kRolloutHeading);
    adjoint.speed += gradient(row, traffic::kRolloutSpeed);
    const State start = stateBefore(initial_speed, rollout, row);
    const ControlAction action = commanded(start.speed, clampedAction(rollout, row));
    const SlipResponse slip = model_.slipResponse(action.steer);
    const ActionAdjoint sum = backwardRow(model_, start, action, slip.slip, adjoint);
    gradient(row, kRolloutThrottle) +=
        within(sum.throttle, rollout(row, kRolloutThrottle), 0.0, 1.0);
    gradient(row, kRolloutSteer) +=
        within(sum.slip * slip.by_steer, rollout(row, kRolloutSteer), -1.0, 1.0);
    gradient(row, kRolloutBrake) += within(sum.brake, rollout(row, kRolloutBrake), 0.0, 1.0);
  }
}

namespace {

constexpr int kSteps = 50;         // of a pedal
constexpr double kStanding = 0.5;  // [m/s]

/// `speed`: mean of those at which the two ticks begin.
double inferSteer(const BicycleModelOptions& options, double turn, double speed) {
  if (speed < kStanding) return 0.0;
  const double sine = turn * options.rear_length / (traffic::kRolloutStep * speed);
  const double slip = std::asin(std::clamp(sine, -0.9, 0.9));
  const double wheel = std::atan(std::tan(slip) * (options.front_length + options.rear_length) /
                                 options.rear_length);
  return std::clamp(wheel / options.steering_gain, -1.0, 1.0);
}

}  // namespace

traffic::ControlAction inferAction(const BicycleModel& model, const ObservedMotion& motion) {
  traffic::ControlAction best;
  double nearest = std::numeric_limits<double>::infinity();
  // From no pedal outwards, so that of equal ones the gentlest wins.
  for (int i = 0; i <= kSteps; ++i) {
    const double pedal = static_cast<double>(i) / kSteps;
    for (const traffic::ControlAction& action :
         {traffic::ControlAction{pedal, 0.0, 0.0}, traffic::ControlAction{0.0, 0.0, pedal}}) {
      const double next = model.nextSpeed(model.nextSpeed(motion.speed, action), action);
      const double error = std::abs(next - motion.next_speed);
      if (error >= nearest) continue;
      nearest = error;
      best = action;
    }
  }
  const double speed = 0.5 * (motion.speed + model.nextSpeed(motion.speed, best));
  best.steer = inferSteer(model.options(), motion.turn, speed);
  return best;
}

}  // namespace cdiff::dynamics
