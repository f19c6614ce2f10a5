// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A straight course for reference drivers (along +x, SI units): the driver's own motion in steps
/// of 0.05 s, and other vehicles that keep their velocity unless a test changes it.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "reference_driver/conflict.h"
#include "reference_driver/reference_driver.h"

namespace cdiff::reference_driver::testing {

inline constexpr double kStep = 0.05;
inline const traffic::VehicleDimensions kCar{4.5, 1.8, 1.5};

inline OwnMotion ownAt(double speed) {
  OwnMotion own;
  own.speed = speed;
  own.dimensions = kCar;
  return own;
}

/// A car with its box along the path, `gap` ahead of the front bumper of a driver at arc length 0.
inline SeenVehicle carAhead(double gap, double speed, double offset = 0.0) {
  SeenVehicle car;
  car.id = 1;
  car.arc_length = gap + kCar.length;
  car.offset = offset;
  car.along_speed = speed;
  car.half_along = 0.5 * kCar.length;
  car.half_across = 0.5 * kCar.width;
  return car;
}

/// A car that crosses the path at `arc_length` from the right, its center `distance` beside it.
inline SeenVehicle carAcross(double arc_length, double distance, double speed) {
  SeenVehicle car;
  car.id = 1;
  car.arc_length = arc_length;
  car.offset = -distance;
  car.across_speed = speed;
  car.half_along = 0.5 * kCar.width;
  car.half_across = 0.5 * kCar.length;
  return car;
}

struct Course {
  bool touched = false;
  std::optional<double> brake_time;
  double gap = 0.0;  ///< to the first vehicle, at the end [m]
  OwnMotion own;
};

/// Drives for `seconds`; `change` is called before each step with the time.
inline Course drive(ReferenceDriver& driver, OwnMotion own, std::vector<SeenVehicle> others,
                    double seconds,
                    const std::function<void(double, std::vector<SeenVehicle>&)>& change = {}) {
  Course course;
  for (int step = 0; step < std::lround(seconds / kStep); ++step) {
    if (change) change(own.time, others);
    const double braking = driver.brake(own, others, kStep);
    if (braking > 0.0 && !course.brake_time) course.brake_time = own.time;
    const double next = std::max(0.0, own.speed - braking * kStep);
    own.arc_length += 0.5 * (own.speed + next) * kStep;
    own.acceleration = (next - own.speed) / kStep;
    own.speed = next;
    own.time += kStep;
    for (SeenVehicle& other : others) {
      const double speed = std::max(0.0, other.along_speed + other.acceleration * kStep);
      const bool along = other.acceleration != 0.0;
      other.arc_length += (along ? 0.5 * (other.along_speed + speed) : other.along_speed) * kStep;
      if (along) other.along_speed = speed;
      if (along && speed <= 0.0) other.acceleration = 0.0;
      other.offset += other.across_speed * kStep;
      const Conflict conflict = conflictOf(own, own.speed, other);
      course.touched = course.touched || (conflict.to_corridor < 0.0 && conflict.gap == 0.0);
    }
  }
  course.own = own;
  course.gap = conflictOf(own, own.speed, others.front()).gap;
  return course;
}

}  // namespace cdiff::reference_driver::testing
