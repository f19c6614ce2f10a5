// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/map/route.h"
#include "planning/route_follower.h"

namespace cdiff::planners {

// The inputs that a camera ego gets from its route, as Bench2Drive's agents do: a command and a
// point.

/// What the route asks for next, in the order of Bench2Drive's labels (CARLA's RoadOption minus 1).
enum class RoadCommand : std::int32_t {
  kLeft = 0,
  kRight = 1,
  kStraight = 2,
  kFollow = 3,
  kChangeLeft = 4,
  kChangeRight = 5
};
inline constexpr std::int64_t kRoadCommands = 6;

/// "left", "right", "straight", "follow", "change_left" or "change_right".
const char* toText(RoadCommand command);

/// A node of the plan along a route (map frame).
struct NavigationNode {
  double arc_length = 0.0;  ///< [m]
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  RoadCommand command = RoadCommand::kFollow;
};

/// The nodes of a route as CARLA's global planner thins them: at the begin of every turn, crossing
/// and lane change, at its end, at least every 50 m, and at the route's end. Unlike there the node
/// at the end of a maneuver keeps its command, so that the command does not end where the maneuver
/// begins.
class Navigation {
 public:
  Navigation(const map::RoadNetwork& network, const map::Route& route);
  /// The next node that is more than 4 m ahead of a place on the route; the last one near its end.
  const NavigationNode& next(double arc_length) const;
  const std::vector<NavigationNode>& nodes() const { return nodes_; }

 private:
  std::vector<NavigationNode> nodes_;  ///< by arc length
};

/// What the route asks of one vehicle from decision to decision.
class NavigationFollower {
 public:
  /// The next node from a place (map frame); a route of another length starts it over.
  const NavigationNode& next(const map::RoadNetwork& network, const map::Route& route,
                             const Eigen::Vector2d& position);

 private:
  planning::RouteFollower follower_;
  std::optional<Navigation> navigation_;
  double route_length_ = 0.0;  ///< of the route that the navigation is of [m]
};

}  // namespace cdiff::planners
