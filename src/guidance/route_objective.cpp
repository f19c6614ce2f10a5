// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "guidance/route_objective.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"

namespace cdiff::guidance {
namespace {

/// Signed offset from the route, positive left, and its gradient on the map.
struct Offset {
  double lateral = 0.0;
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
  double heading = 0.0;
};

Offset offsetFrom(const map::Route& route, double arc_length, const Eigen::Vector2d& position) {
  const auto [begin, end] = route.path().around(arc_length, kRouteReach);
  const geometry::Projection nearest = route.path().project(position, begin, end);
  const Eigen::Vector2d away = position - route.path().positionAt(nearest.arc_length);
  const Eigen::Vector2d left = geometry::leftNormal(geometry::direction(nearest.heading));
  const bool at_end = nearest.arc_length <= begin || nearest.arc_length >= end;
  const bool on_line = std::abs(nearest.lateral_offset) < 1e-9;
  if (at_end || on_line) return {left.dot(away), left, nearest.heading};
  return {nearest.lateral_offset, away / nearest.lateral_offset, nearest.heading};
}

}  // namespace

void RouteObjective::describe(core::OptionsVisitor& visitor) {
  visitor.number({"free_offset", "m", "Lateral offset from the route that costs nothing."},
                 free_offset, 0.0, 20.0);
  visitor.number({"heading_weight", "m^2/rad^2", "Weight of the squared heading difference."},
                 heading_weight, 0.0, 1000.0);
}

double RouteObjective::evaluate(const GuidanceScene& scene, const traffic::Rollout& rollout,
                                traffic::Rollout& gradient) const {
  if (scene.route == nullptr || scene.route->empty()) return 0.0;
  double sum = 0.0;
  for (Eigen::Index row = 0; row < rollout.rows(); ++row) {
    const Offset offset =
        offsetFrom(*scene.route, scene.route_arc_length, positionOnMap(scene, rollout, row));
    const double excess = std::max(0.0, std::abs(offset.lateral) - free_offset);
    const double sign = offset.lateral < 0.0 ? -1.0 : 1.0;
    addPositionGradient(scene, 2.0 * excess * sign * offset.gradient, row, gradient);
    const double turned = core::angleDifference(
        scene.state.heading + rollout(row, traffic::kRolloutHeading), offset.heading);
    gradient(row, traffic::kRolloutHeading) += 2.0 * heading_weight * turned;
    sum += excess * excess + heading_weight * turned * turned;
  }
  return sum;
}

std::unique_ptr<Objective> RouteObjective::clone() const {
  return std::make_unique<RouteObjective>(*this);
}

}  // namespace cdiff::guidance
