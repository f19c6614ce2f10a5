// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/dynamics/bicycle_model.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::dynamics {
namespace {

constexpr double kTick = BicycleModel::kTick;
constexpr double kKmhPerMps = 3.6;      // [km/h per m/s]
constexpr double kDriveThrottle = 0.3;  // below it the fitted model keeps the speed
constexpr double kStandstill = 1e-3;    // [m/s] below it a braking car stops

/// Speed [km/h] one tick after speed v [km/h] under a throttle u of at least kDriveThrottle.
double drivenSpeed(double v, double u) {
  return 0.963873001 * v + 4.37535692e-4 * v * v - 0.380192912 * u + 1.74950069 * u * u +
         0.0916787414 * v * u - 0.0705461530 * v * u * u - 1.05996152e-3 * v * v * u +
         6.71079346e-4 * v * v * u * u;
}

/// d drivenSpeed / d v.
double drivenSpeedByV(double v, double u) {
  return 0.963873001 + 2.0 * 4.37535692e-4 * v + 0.0916787414 * u - 0.0705461530 * u * u -
         2.0 * 1.05996152e-3 * v * u + 2.0 * 6.71079346e-4 * v * u * u;
}

/// d drivenSpeed / d u [km/h].
double drivenSpeedByU(double v, double u) {
  return -0.380192912 + 2.0 * 1.74950069 * u + 0.0916787414 * v - 2.0 * 0.0705461530 * v * u -
         1.05996152e-3 * v * v + 2.0 * 6.71079346e-4 * v * v * u;
}

/// Coefficients of brakedSpeed, highest power first; there is no constant term.
constexpr double kBrakeFit[] = {-4.91381935e-12, 2.44419284e-9, -4.90357228e-7, 5.06587474e-5,
                                -2.83832427e-3,  8.20967431e-2, 9.31711370e-3};

/// Speed [km/h] one tick after speed v [km/h] under full brake, before the cap (Horner's scheme).
double brakedSpeed(double v) {
  double value = 0.0;
  for (const double coefficient : kBrakeFit) value = (value + coefficient) * v;
  return value;
}

/// d brakedSpeed / d v.
double brakedSpeedByV(double v) {
  double value = 0.0;
  double derivative = 0.0;
  for (const double coefficient : kBrakeFit) {
    derivative = derivative * v + (value + coefficient);
    value = (value + coefficient) * v;
  }
  return derivative;
}

/// Number of ticks in `duration` [s].
long tickCount(double duration) {
  const double ticks = duration / kTick;
  if (!std::isfinite(ticks) || ticks < -1e-6 || std::abs(ticks - std::round(ticks)) > 1e-6) {
    throw std::invalid_argument("BicycleModel: duration " + core::formatNumber(duration) +
                                " s is not a multiple of 0.05 s");
  }
  return std::lround(ticks);
}

void requireValid(const traffic::ControlAction& action) {
  if (action.valid()) return;
  throw std::invalid_argument("BicycleModel: action (throttle " +
                              core::formatNumber(action.throttle) + ", steer " +
                              core::formatNumber(action.steer) + ", brake " +
                              core::formatNumber(action.brake) + ") is not finite or out of range");
}

}  // namespace

void BicycleModelOptions::describe(core::OptionsVisitor& visitor) {
  visitor.number({"steering_gain", "rad", "Wheel angle at steer = 1."}, steering_gain, 0.01, 1.2);
  visitor.number({"rear_length", "m", "Center to rear axle of the fitted bicycle."}, rear_length,
                 0.1, 10.0);
  visitor.number({"front_length", "m", "Center to front axle of the fitted bicycle."}, front_length,
                 -5.0, 10.0);
  visitor.number({"max_deceleration", "m/s^2", "Cap of the deceleration under full brake."},
                 max_deceleration, 0.1, 20.0);
  visitor.number({"max_speed", "m/s", "Speed that is never exceeded."}, max_speed, 1.0, 100.0);
}

void BicycleModelOptions::validate() const {
  if (!(rear_length > 0.0) || !(rear_length + front_length > 0.0)) {
    throw core::InputError("vehicle: rear_length " + core::formatNumber(rear_length) +
                           " and rear_length + front_length " +
                           core::formatNumber(rear_length + front_length) + " must be positive");
  }
  if (!(max_deceleration > 0.0) || !(max_speed > 0.0)) {
    throw core::InputError("vehicle: max_deceleration " + core::formatNumber(max_deceleration) +
                           " and max_speed " + core::formatNumber(max_speed) + " must be positive");
  }
}

BicycleModel::BicycleModel(const BicycleModelOptions& options) : options_(options) {
  options_.validate();
}

double BicycleModel::nextSpeed(double speed, const traffic::ControlAction& action) const {
  const double v = speed * kKmhPerMps;
  const double drive = action.throttle < kDriveThrottle ? 0.0 : drivenSpeed(v, action.throttle) - v;
  const double strongest = -options_.max_deceleration * kTick * kKmhPerMps;
  const double brake = std::clamp(brakedSpeed(v) - v, strongest, 0.0);
  const double change = (1.0 - action.brake) * drive + action.brake * brake;
  const double next = std::clamp((v + change) / kKmhPerMps, 0.0, options_.max_speed);
  return action.brake > 0.0 && change <= 0.0 && next < kStandstill ? 0.0 : next;
}

SpeedResponse BicycleModel::speedResponse(double speed,
                                          const traffic::ControlAction& action) const {
  SpeedResponse response;
  response.speed = nextSpeed(speed, action);
  const double v = speed * kKmhPerMps;
  const bool driven = action.throttle >= kDriveThrottle;
  const double drive = driven ? drivenSpeed(v, action.throttle) - v : 0.0;
  const double strongest = -options_.max_deceleration * kTick * kKmhPerMps;
  const double uncapped = brakedSpeed(v) - v;
  const double brake = std::clamp(uncapped, strongest, 0.0);
  const double raw = (v + (1.0 - action.brake) * drive + action.brake * brake) / kKmhPerMps;
  const bool stands = response.speed == 0.0 && raw > 0.0;  // stopped from below kStandstill
  if (raw < 0.0 || raw > options_.max_speed || stands) return response;
  const double drive_by_v = driven ? drivenSpeedByV(v, action.throttle) - 1.0 : 0.0;
  const double brake_by_v = uncapped == brake ? brakedSpeedByV(v) - 1.0 : 0.0;
  response.by_speed = 1.0 + (1.0 - action.brake) * drive_by_v + action.brake * brake_by_v;
  response.by_brake = (brake - drive) / kKmhPerMps;
  if (driven) {
    response.by_throttle = (1.0 - action.brake) * drivenSpeedByU(v, action.throttle) / kKmhPerMps;
  }
  return response;
}

double BicycleModel::slip(double steer) const {
  const double wheel_angle = options_.steering_gain * steer;
  const double wheelbase = options_.rear_length + options_.front_length;
  return std::atan(options_.rear_length / wheelbase * std::tan(wheel_angle));
}

SlipResponse BicycleModel::slipResponse(double steer) const {
  const double ratio = options_.rear_length / (options_.rear_length + options_.front_length);
  const double tangent = std::tan(options_.steering_gain * steer);
  const double scaled = ratio * tangent;
  return {std::atan(scaled),
          options_.steering_gain * ratio * (1.0 + tangent * tangent) / (1.0 + scaled * scaled)};
}

traffic::VehicleState BicycleModel::step(const traffic::VehicleState& state,
                                         const traffic::ControlAction& action,
                                         double duration) const {
  requireValid(action);
  const long ticks = tickCount(duration);
  const double slip = this->slip(action.steer);
  traffic::VehicleState next = state;
  for (long tick = 0; tick < ticks; ++tick) {
    next.position += next.speed * kTick * geometry::direction(next.heading + slip);
    next.heading =
        core::wrapAngle(next.heading + next.speed / options_.rear_length * std::sin(slip) * kTick);
    next.speed = nextSpeed(next.speed, action);
  }
  return next;
}

}  // namespace cdiff::dynamics
