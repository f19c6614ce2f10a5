// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "guidance/drivable_area_objective.h"

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

}  // namespace

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

}  // namespace cdiff::guidance
