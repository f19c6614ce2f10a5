// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "suite/network_generator.h"
#include "suite/road_plan.h"

namespace cdiff::suite {

// The kinds of networks, a file each, and the roads that lead to a junction.

/// Width of every lane [m], as networks/netconvert.netccfg has it.
inline constexpr double kLaneWidth = 3.5;

RoadPlan drawCrossing(const NetworkSpec& spec, Draws& draws);
RoadPlan drawRoundabout(const NetworkSpec& spec, Draws& draws);
RoadPlan drawMerge(const NetworkSpec& spec, Draws& draws);
RoadPlan drawDistrict(const NetworkSpec& spec, Draws& draws);

/// Limits of small and of larger roads: 30 to 50 and 40 to 70 km/h [m/s].
double drawSmallSpeed(Draws& draws);
double drawLargeSpeed(Draws& draws);

/// How the roads of one junction bend: all to one side, so that they never meet again.
class ArmShape {
 public:
  ArmShape(bool elevation, Draws& draws) : side_(draws.sign()), elevation_(elevation) {}
  /// The middle of a road of some 110 to 240 m away from `start`: straight for its first 45 m, then
  /// often a bend that can be driven at `speed` [m/s] with 3 m/s^2 to the side.
  Line draw(const Eigen::Vector2d& start, double heading, double speed, Draws& draws) const;

 private:
  double side_;
  bool elevation_;
};

/// Both directions of a road: "NAME_in" towards the node `inner`, "NAME_out" away from it.
struct ArmPlan {
  std::string name;
  std::string inner;
  Line line;  ///< its middle, outwards
  int lanes = 1;
  double speed = 13.89;  ///< [m/s]
  int priority = 5;
};
/// Adds the two edges and the node at the road's end.
void addArm(const ArmPlan& arm, RoadPlan& plan);

}  // namespace cdiff::suite
