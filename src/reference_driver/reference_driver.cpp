// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "reference_driver/reference_driver.h"

#include <algorithm>

namespace cdiff::reference_driver {

std::unique_ptr<ReferenceDriver> UnresponsiveDriver::clone() const {
  return std::make_unique<UnresponsiveDriver>(*this);
}

double BrakeRamp::press(double demand, double jerk, double duration, const OwnMotion& own) {
  constexpr double kMostMissing = 2.0;  // between what was asked and what the vehicle does [m/s^2]
  constexpr double kSlow = 1.0;         // whose last decelerations end early [m/s]
  if (own.speed > kSlow && -own.acceleration < level_ - kMostMissing) level_ = 0.0;
  const double before = std::min(level_, demand);
  level_ = std::min(demand, before + jerk * duration);
  const double rising = (level_ - before) / jerk;  // [s]
  return level_ - 0.5 * (level_ - before) * std::min(1.0, rising / duration);
}

}  // namespace cdiff::reference_driver
