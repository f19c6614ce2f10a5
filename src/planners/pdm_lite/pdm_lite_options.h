// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "e2e_cdiff/core/options.h"
#include "planning/windowed_pid.h"

namespace cdiff::planners {

/// The constants in which the published configurations of PDM-Lite differ: RIFT's `rift`, for ten
/// decisions a second, and DriveLM's `original`, for twenty.
struct PdmLiteConfiguration {
  double lateral_kp = 2.0;           ///< gain of the steering, per call
  std::int64_t lateral_window = 20;  ///< errors in the mean of the steering, one per call
  double top_speed = 0.0;            ///< cap of the initial target speed [m/s]; 0: none
};

/// How a vehicle follows by IDM (defaults: PDM-Lite's). With an acceleration the style is *even*:
/// the pedals are smooth instead of switching between full throttle and full brake.
struct DrivingStyle {
  double minimum_gap = 4.0;    ///< s0 behind a leader [m]
  double time_headway = 0.25;  ///< T [s]
  double acceleration = 0.0;   ///< a [m/s^2]; 0: PDM-Lite's own pedals, full or none
  double deceleration = 3.0;   ///< b, comfortable, where a is given [m/s^2]

  bool even() const { return acceleration > 0.0; }
};

/// Options of PDM-Lite. A key that is 0 where that says so has its configuration's value.
struct PdmLiteOptions {
  std::string configuration = "rift";  ///< rift | original
  double speed_limit_share = 0.72;     ///< initial target speed as a share of the limit
  double top_speed = 0.0;              ///< cap of it [m/s]; 0: the configuration's
  double junction_speed = 64.0 / 3.6;  ///< cap when a junction lies within 30 m [m/s]
  double forecast_horizon = 2.0;       ///< how far boxes are forecast [s]
  double detection_radius = 50.0;      ///< vehicles that are forecast [m]
  /// Of the steering; kp 0: the configuration's.
  planning::PidGains lateral{0.0, 0.6406067986034124, 1.3782508892109167};
  std::int64_t lateral_window = 0;  ///< errors in the integral; 0: the configuration's
  bool obey_lights = true;          ///< stop for lights that are not green
  bool obey_stop_signs = true;      ///< stop at stop signs
  double cbv_acceleration = 0.0;    ///< a of CBVs, which are then even; 0: as published [m/s^2]
  double cbv_deceleration = 3.0;    ///< b of even CBVs [m/s^2]
  double cbv_speed_spread = 0.0;    ///< of CBVs' target speeds, as a share of them; 0: one driver
  double cbv_headway_spread = 0.0;  ///< of CBVs' time headways; 0: one driver [s]
  /// The style of a vehicle, by its id; no key: data collection sets it. Empty: the default.
  std::function<DrivingStyle(const std::string& vehicle_id)> styles;

  void describe(core::OptionsVisitor& visitor);
  void validate() const;
  /// The named configuration with the keys that are given on top. Throws InputError for a name that
  /// is not known.
  PdmLiteConfiguration resolved() const;
};

}  // namespace cdiff::planners
