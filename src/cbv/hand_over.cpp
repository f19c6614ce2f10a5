// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "cbv/hand_over.h"

#include <algorithm>
#include <cmath>

namespace cdiff::cbv {
namespace {

constexpr double kStep = 0.1;     // [s]
constexpr double kBraking = 4.0;  // [m/s^2], the upper end of comfortable

bool touches(const Motion& handed_over, double deceleration, const std::vector<Motion>& others,
             double time) {
  const geometry::OrientedBox box = handed_over.boxAfter(time, deceleration);
  return std::any_of(others.begin(), others.end(), [&](const Motion& other) {
    return !traffic::onDifferentLevels(handed_over.vehicle, other.vehicle) &&
           geometry::overlap(box, other.boxAfter(time));
  });
}

}  // namespace

geometry::OrientedBox Motion::boxAfter(double time, double deceleration) const {
  const double speed = vehicle.state.speed;
  const double moving = deceleration > 0.0 ? std::min(time, speed / deceleration) : time;
  const double driven = speed * moving - 0.5 * deceleration * moving * moving;
  geometry::OrientedBox box = vehicle.box();
  if (path == nullptr) {
    box.center += driven * geometry::direction(vehicle.state.heading);
  } else {
    const geometry::Pose2d pose = path->extendedPoseAt(arc_length + driven);
    box.center = pose.position;
    box.heading = pose.heading;
  }
  return box;
}

bool contactAhead(const Motion& handed_over, const std::vector<Motion>& others, double time) {
  for (int i = 0; i * kStep <= time + 1e-9; ++i) {
    for (const double deceleration : {0.0, kBraking})
      if (touches(handed_over, deceleration, others, i * kStep)) return true;
  }
  return false;
}

}  // namespace cdiff::cbv
