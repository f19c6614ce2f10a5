// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "e2e_cdiff/AckermannCommand.h"
#include "geometry_msgs/Twist.h"
#include "nav_msgs/Path.h"
#include "planning/ego_commands.h"

namespace cdiff::node_graph {

// Commands of an external ego from their messages. All throw core::InputError for what the ego's
// dynamics has no word for.

/// Throws for an unknown drive_by.
planning::AckermannCommand fromMsg(const ::e2e_cdiff::AckermannCommand& message);
/// Throws unless linear.y, linear.z, angular.x and angular.y are 0.
planning::VelocityCommand fromMsg(const geometry_msgs::Twist& message);
/// The stamps of the poses are simulated time. Throws for a frame other than `map`.
std::vector<planning::TimedPlace> trajectoryFrom(const nav_msgs::Path& message);

}  // namespace cdiff::node_graph
