// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "e2e_cdiff/geometry/shapes.h"

namespace cdiff::simulation {

// SUMO's conventions and ours: SUMO places a vehicle by the center of its front bumper and an angle
// in degrees clockwise from north; we by the center of its box and a heading in radians
// counter-clockwise from east. center = front - L/2 (cos, sin)(heading).

/// A value that SUMO answers with. Throws SimulatorError naming it and whose it is when it is not
/// finite.
double finiteAnswer(double value, const char* quantity, const std::string& id);

/// Heading of a navigation angle [deg], in (-pi, pi] [rad].
double headingFromAngle(double angle_degrees);

/// Navigation angle of a heading [rad], in [0, 360) [deg].
double angleFromHeading(double heading);

/// Front bumper of a vehicle whose center is at `pose` [m].
Eigen::Vector2d frontOf(const geometry::Pose2d& pose, double length);

/// Center of a vehicle whose front bumper is at `front` [m].
Eigen::Vector2d centerBehind(const Eigen::Vector2d& front, double heading, double length);

}  // namespace cdiff::simulation
