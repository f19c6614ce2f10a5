// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "reference_driver/driven_path.h"

namespace cdiff::reference_driver {

/// A model of a driver of known quality that keeps its speed on its path until another vehicle
/// makes it brake (map frame, SI units). It sees the present and the past, never a plan, and does
/// not steer away, as in UN R157.
class ReferenceDriver {
 public:
  virtual ~ReferenceDriver() = default;
  /// Mean deceleration that it applies for `duration` from now on [m/s^2]; 0 where nothing makes it
  /// brake. One call per step, in the order of time; `seen` holds the vehicles along the path.
  virtual double brake(const OwnMotion& own, const std::vector<SeenVehicle>& seen,
                       double duration) = 0;
  /// A copy with all that it remembers.
  virtual std::unique_ptr<ReferenceDriver> clone() const = 0;
};

/// Of times that are compared, against rounding [s].
inline constexpr double kTimeTolerance = 1e-9;

/// The driver that reacts to nothing.
class UnresponsiveDriver final : public ReferenceDriver {
 public:
  double brake(const OwnMotion&, const std::vector<SeenVehicle>&, double) override { return 0.0; }
  std::unique_ptr<ReferenceDriver> clone() const override;
};

/// The pedal on its way down: deceleration grows evenly up to the demand, and ends at once.
class BrakeRamp {
 public:
  /// Mean deceleration over `duration` with `jerk` [m/s^3] toward `demand` [m/s^2]. A vehicle that
  /// did not brake as this pedal asked was driven by another: the pedal goes down anew.
  double press(double demand, double jerk, double duration, const OwnMotion& own);
  void release() { level_ = 0.0; }

 private:
  double level_ = 0.0;  ///< at the end of the last step [m/s^2]
};

}  // namespace cdiff::reference_driver
