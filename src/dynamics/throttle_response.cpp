// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "dynamics/throttle_response.h"

#include <stdexcept>

namespace cdiff::dynamics {
namespace {

/// Speed that the throttle alone adds in a tick [m/s]; exactly 0 where the fit ignores it.
double throttleChange(const BicycleModel& model, double speed, double throttle) {
  return model.nextSpeed(speed, {throttle, 0.0, 0.0}) - model.nextSpeed(speed, {});
}

}  // namespace

PedalUse pedalUse(const BicycleModel& model, double speed, const traffic::ControlAction& action) {
  if (action.brake > 0.0) return PedalUse::kBraking;
  const double change = throttleChange(model, speed, action.throttle);
  if (change < 0.0) return PedalUse::kNotch;
  return change > 0.0 ? PedalUse::kDriving : PedalUse::kCoasting;
}

ThrottleResponse throttleResponse(const std::string& name) {
  if (name == "fitted") return ThrottleResponse::kFitted;
  if (name == "monotone") return ThrottleResponse::kMonotone;
  throw std::invalid_argument("throttle response '" + name + "'; expected fitted or monotone");
}

traffic::ControlAction commandedAction(const BicycleModel& model, ThrottleResponse response,
                                       double speed, const traffic::ControlAction& action) {
  traffic::ControlAction commanded = action;
  const bool monotone = response == ThrottleResponse::kMonotone;
  if (monotone && throttleChange(model, speed, action.throttle) < 0.0) commanded.throttle = 0.0;
  return commanded;
}

}  // namespace cdiff::dynamics
