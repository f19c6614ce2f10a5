// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "guidance/driving_objectives.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"

namespace cdiff::guidance {
namespace {

/// A point on the box's long axis.
struct DrivableAreaPoint {
  double ahead;   ///< of the center [m]
  double share;   ///< of the row's mean
  double margin;  ///< [m]
};

/// The term of one point; adds its gradient.
double addPoint(const GuidanceScene& scene, const traffic::Rollout& rollout, Eigen::Index row,
                const DrivableAreaPoint& point, traffic::Rollout& gradient) {
  const double heading = scene.state.heading + rollout(row, traffic::kRolloutHeading);
  const Eigen::Vector2d arm = point.ahead * geometry::direction(heading);
  const map::SignedDistance border = scene.drivable_area->signedDistanceWithGradient(
      positionOnMap(scene, rollout, row) + arm, scene.state.elevation);
  const double missing = point.margin - border.distance;
  if (missing <= 0.0) return 0.0;
  const Eigen::Vector2d pull = -2.0 * point.share * missing * border.gradient;
  addPositionGradient(scene, pull, row, gradient);
  gradient(row, traffic::kRolloutHeading) += pull.dot(geometry::leftNormal(arm));
  return point.share * missing * missing;
}

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

void SpeedObjective::describe(core::OptionsVisitor& visitor) {
  visitor.number({"factor", "", "Share of the target speed v* that is aimed at."}, factor, 0.0,
                 3.0);
}

double SpeedObjective::evaluate(const GuidanceScene& scene, const traffic::Rollout& rollout,
                                traffic::Rollout& gradient) const {
  const double target = factor * scene.target_speed;
  double sum = 0.0;
  for (Eigen::Index row = 0; row < rollout.rows(); ++row) {
    const double excess = rollout(row, traffic::kRolloutSpeed) - target;
    sum += excess * excess;
    gradient(row, traffic::kRolloutSpeed) += 2.0 * excess;
  }
  return sum;
}

std::unique_ptr<Objective> SpeedObjective::clone() const {
  return std::make_unique<SpeedObjective>(*this);
}

void DrivableAreaObjective::describe(core::OptionsVisitor& visitor) {
  visitor.number({"margin", "m", "Distance to the border at which the pull starts."}, margin, 0.0,
                 20.0);
  visitor.text({"points", "", "Points of the box: its center, or center, front and rear."}, points,
               {"center", "bumpers"});
}

double DrivableAreaObjective::evaluate(const GuidanceScene& scene, const traffic::Rollout& rollout,
                                       traffic::Rollout& gradient) const {
  const double half_length = 0.5 * scene.dimensions.length;
  double sum = 0.0;
  for (Eigen::Index row = 0; row < rollout.rows(); ++row) {
    if (points == "center") {
      sum += addPoint(scene, rollout, row, {0.0, 1.0, margin}, gradient);
      continue;
    }
    for (const double ahead : {-half_length, 0.0, half_length}) {
      sum += addPoint(scene, rollout, row, {ahead, 1.0 / 3.0, margin}, gradient);
    }
  }
  return sum;
}

std::unique_ptr<Objective> DrivableAreaObjective::clone() const {
  return std::make_unique<DrivableAreaObjective>(*this);
}

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

void ComfortObjective::describe(core::OptionsVisitor& visitor) {
  visitor.number({"action_weight", "", "Weight of squared differences of consecutive actions."},
                 action_weight, 0.0, 1000.0);
  visitor.number({"lateral_weight", "s^4/m^2", "Weight of the squared lateral acceleration."},
                 lateral_weight, 0.0, 1000.0);
}

double ComfortObjective::evaluate(const GuidanceScene&, const traffic::Rollout& rollout,
                                  traffic::Rollout& gradient) const {
  constexpr int kActions = traffic::kActionColumns;
  double sum = 0.0;
  for (Eigen::Index row = 0; row < rollout.rows(); ++row) {
    const double before = row == 0 ? 0.0 : rollout(row - 1, traffic::kRolloutHeading);
    const double turned = rollout(row, traffic::kRolloutHeading) - before;
    const double speed = rollout(row, traffic::kRolloutSpeed);
    const double lateral = speed * turned / traffic::kRolloutStep;
    const double by_lateral = 2.0 * lateral_weight * lateral / traffic::kRolloutStep;
    sum += lateral_weight * lateral * lateral;
    gradient(row, traffic::kRolloutSpeed) += by_lateral * turned;
    gradient(row, traffic::kRolloutHeading) += by_lateral * speed;
    if (row == 0) continue;
    gradient(row - 1, traffic::kRolloutHeading) -= by_lateral * speed;
    const Eigen::Matrix<double, 1, kActions> change =
        rollout.row(row).tail<kActions>() - rollout.row(row - 1).tail<kActions>();
    sum += action_weight * change.squaredNorm();
    gradient.row(row).tail<kActions>() += 2.0 * action_weight * change;
    gradient.row(row - 1).tail<kActions>() -= 2.0 * action_weight * change;
  }
  return sum;
}

std::unique_ptr<Objective> ComfortObjective::clone() const {
  return std::make_unique<ComfortObjective>(*this);
}

}  // namespace cdiff::guidance
