// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/traffic/vehicle.h"

#include <cmath>

namespace cdiff::traffic {
namespace {

bool within(double value, double low, double high) {
  return std::isfinite(value) && value >= low && value <= high;
}

}  // namespace

bool ControlAction::valid() const {
  return within(throttle, 0.0, 1.0) && within(steer, -1.0, 1.0) && within(brake, 0.0, 1.0);
}

bool operator==(const ControlAction& left, const ControlAction& right) {
  return left.throttle == right.throttle && left.steer == right.steer && left.brake == right.brake;
}

const char* toText(VehicleRole role) {
  switch (role) {
    case VehicleRole::kEgo:
      return "ego";
    case VehicleRole::kCbv:
      return "cbv";
    case VehicleRole::kBackground:
      break;
  }
  return "background";
}

}  // namespace cdiff::traffic
