// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "e2e_cdiff/core/options.h"

namespace cdiff::planners {

/// Options of PDM-Lite; defaults are RIFT's configuration of it.
struct PdmLiteOptions {
  double speed_limit_share = 0.72;  ///< initial target speed as a share of the limit
  double junction_speed = 17.78;    ///< cap when a junction lies within 30 m [m/s]
  double forecast_horizon = 2.0;    ///< how far boxes are forecast [s]
  double detection_radius = 50.0;   ///< vehicles that are forecast [m]
  double lateral_kp = 2.0;          ///< RIFT's gain (original: 3.118)
  double lateral_ki = 0.6406067986034124;
  double lateral_kd = 1.3782508892109167;
  std::int64_t lateral_window = 20;  ///< errors in the integral (original: 6)
  bool obey_lights = true;           ///< stop for lights that are not green
  double cbv_acceleration = 0.0;     ///< a of CBVs, which are then even; 0: as published [m/s^2]
  double cbv_deceleration = 3.0;     ///< b of even CBVs [m/s^2]
  double cbv_speed_spread = 0.0;     ///< of CBVs' target speeds, as a share of them; 0: one driver
  double cbv_headway_spread = 0.0;   ///< of CBVs' time headways; 0: one driver [s]

  void describe(core::OptionsVisitor& visitor);
  void validate() const;
};

}  // namespace cdiff::planners
