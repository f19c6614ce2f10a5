// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::dynamics {

/// Parameters of the bicycle model: geometry [m], steering gain and limits (SI units).
struct BicycleModelOptions {
  double steering_gain = 0.36848336;   ///< wheel angle at steer = 1 [rad]
  double rear_length = 1.4178275;      ///< center to rear axle l_r [m]
  double front_length = -0.090769015;  ///< center to front axle l_f of the fit [m]
  double max_deceleration = 8.0;       ///< cap of braking [m/s^2]
  double max_speed = 40.0;             ///< [m/s]

  void describe(core::OptionsVisitor& visitor);  ///< visits every option
  /// Throws InputError unless lengths, wheelbase and limits are positive.
  void validate() const;
};

/// Speed one tick (0.05 s) later and its derivatives.
struct SpeedResponse {
  double speed = 0.0;        ///< [m/s]
  double by_speed = 0.0;     ///< d next / d speed
  double by_throttle = 0.0;  ///< d next / d throttle [m/s]
  double by_brake = 0.0;     ///< d next / d brake [m/s]
};

/// Slip angle of the center and its derivative.
struct SlipResponse {
  double slip = 0.0;      ///< [rad]
  double by_steer = 0.0;  ///< d slip / d steer [rad]
};

/// Kinematic bicycle with a throttle and brake response: (throttle, steer, brake) -> next state.
/// Map frame, SI units; one step per simulation step of 0.05 s (coefficients: reference design,
/// PDM-Lite's fit of a mid-size car).
///
/// Steering: slip = atan(l_r / (l_f + l_r) tan(gain steer)); x' = v cos(heading + slip),
/// y' = v sin(heading + slip), heading' = v / l_r sin(slip); Euler with the speed at the start of
/// the 0.05 s. Speed per 0.05 s, in km/h:
///  - throttle u >= 0.3: the fit's polynomial in v and u; u < 0.3: unchanged, as published. So the
///    car neither coasts down nor starts on less than 0.3, and at speed a throttle just above 0.3
///    slows it while one just below does not: use the brake to slow down.
///  - brake 1: the fit's polynomial, the change limited to [-max_deceleration, 0]; below 1 mm/s it
///    stands.
///  - between (the fit has no partial brake): change = (1 - brake) x change of the throttle +
///    brake x change of full brake.
class BicycleModel {
 public:
  /// Throws InputError for options that BicycleModelOptions::validate refuses.
  explicit BicycleModel(const BicycleModelOptions& options = {});
  /// State after `duration` [s] with the action held; `duration` is a multiple of 0.05 s up to
  /// rounding, the polynomials being per 0.05 s. Never reverses. Elevation is kept. Throws
  /// std::invalid_argument for an invalid action.
  traffic::VehicleState step(const traffic::VehicleState& state,
                             const traffic::ControlAction& action, double duration) const;
  /// What it was made with.
  const BicycleModelOptions& options() const { return options_; }

  // The parts of a tick, for derivatives along many ticks; the action is not checked. Where the
  // response has a kink (0.3 of throttle, caps, standstill) the derivative is that of the branch
  // that `step` takes.
  static constexpr double kTick = 0.05;  ///< [s] the period that the fitted polynomials describe
  /// Slip angle of the center at a steer in [-1, 1] [rad].
  double slip(double steer) const;
  /// The same with its derivative.
  SlipResponse slipResponse(double steer) const;
  /// Speed one tick after `speed` [m/s].
  double nextSpeed(double speed, const traffic::ControlAction& action) const;
  /// The same with its derivatives.
  SpeedResponse speedResponse(double speed, const traffic::ControlAction& action) const;

 private:
  BicycleModelOptions options_;
};

}  // namespace cdiff::dynamics
