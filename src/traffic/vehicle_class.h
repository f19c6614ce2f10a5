// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <algorithm>
#include <cstdint>

#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::traffic {

/// What kind of body a vehicle has, told by its box; the numbers are those of scene files.
enum class VehicleClass : std::uint8_t {
  kCar = 0,
  kLarge = 1,  ///< vans, trucks and buses: higher than 2.1 m or longer than 6.5 m
  kNarrow = 2  ///< bicycles and motorcycles: at most 1.1 m wide
};

inline VehicleClass classOf(const VehicleDimensions& size) {
  constexpr double kTallBody = 2.1;    // [m]
  constexpr double kLongBody = 6.5;    // [m]
  constexpr double kNarrowBody = 1.1;  // [m]
  if (size.width <= kNarrowBody) return VehicleClass::kNarrow;
  const bool large = size.height > kTallBody || size.length > kLongBody;
  return large ? VehicleClass::kLarge : VehicleClass::kCar;
}

/// Whether a box is that of a pedestrian, a bicycle or a small object: shorter than any car.
inline bool isSmall(const VehicleDimensions& size) { return size.length < 2.0; }

/// Whether a box stands upright: that of a pedestrian or of a still object.
inline bool isUpright(const VehicleDimensions& size) {
  constexpr double kWidest = 1.1;  // [m]
  return std::max(size.length, size.width) <= kWidest;
}

}  // namespace cdiff::traffic
