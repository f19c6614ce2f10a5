// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "simulation/sumo_conventions.h"

#include <cmath>
#include <pugixml.hpp>

#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/geometry/shapes.h"

namespace cdiff::simulation {

double finiteAnswer(double value, const char* quantity, const std::string& id) {
  if (std::isfinite(value)) return value;
  throw core::SimulatorError("SUMO answers that the " + std::string(quantity) + " of '" +
                             core::shortened(id) + "' is " + std::to_string(value) +
                             "; a finite number was expected; check the program sumo");
}

double headingFromAngle(double angle_degrees) {
  return core::wrapAngle(core::degreesToRadians(90.0 - angle_degrees));
}

double angleFromHeading(double heading) {
  const double angle = std::fmod(90.0 - core::radiansToDegrees(heading), 360.0);
  return angle < 0.0 ? angle + 360.0 : angle;
}

Eigen::Vector2d frontOf(const geometry::Pose2d& pose, double length) {
  return pose.position + 0.5 * length * geometry::direction(pose.heading);
}

Eigen::Vector2d centerBehind(const Eigen::Vector2d& front, double heading, double length) {
  return front - 0.5 * length * geometry::direction(heading);
}

}  // namespace cdiff::simulation
