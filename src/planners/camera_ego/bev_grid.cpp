// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/camera_ego/bev_grid.h"

#include <algorithm>

#include "planners/camera_ego/camera_ego_sizes.h"

namespace cdiff::planners {
namespace {

constexpr double kNearest = 0.5;  // depth in front of a camera at which it sees [m]
constexpr float kNowhere = -1e4F;

/// A cell's pillar in an image: (column, row) in cells for each height, and whether any lies in it.
struct VisiblePillar {
  Eigen::Vector2f places[kPillarPoints];
  bool seen = false;
};

VisiblePillar pillarIn(const rendering::RigCamera& camera,
                       const Eigen::Matrix<double, 3, 4>& matrix, const Eigen::Vector2d& center,
                       std::int64_t stride) {
  VisiblePillar pillar;
  const auto step = static_cast<double>(stride);
  for (std::int64_t i = 0; i < kPillarPoints; ++i) {
    const Eigen::Vector3d pixel =
        matrix * Eigen::Vector4d(center.x(), center.y(), kPillarHeights[i], 1.0);
    pillar.places[i] = {kNowhere, kNowhere};
    if (pixel.z() < kNearest) continue;
    const Eigen::Vector2d at = pixel.head<2>() / pixel.z();
    const bool inside = at.x() >= -0.5 && at.y() >= -0.5 &&
                        at.x() < static_cast<double>(camera.width) - 0.5 &&
                        at.y() < static_cast<double>(camera.height) - 0.5;
    pillar.seen = pillar.seen || inside;
    pillar.places[i] = ((at.array() + 0.5) / step - 0.5).cast<float>();
  }
  return pillar;
}

void addPlace(const Eigen::Vector2f& place, std::int64_t times, std::vector<float>& references) {
  for (std::int64_t i = 0; i < times; ++i)
    references.insert(references.end(), {place.x(), place.y()});
}

}  // namespace

void BevGrid::describe(core::OptionsVisitor& visitor) {
  visitor.integer({"rows", "", "Cells of the BEV along the ego."}, rows, 4, 400);
  visitor.integer({"columns", "", "Cells of the BEV across the ego."}, columns, 4, 400);
  visitor.number({"cell", "m", "Side of a cell of the BEV."}, cell, 0.1, 10.0);
  visitor.number({"behind", "m", "How far the BEV reaches behind the ego's center."}, behind, 0.0,
                 100.0);
}

Eigen::Vector2d BevGrid::center(std::int64_t index) const {
  const std::int64_t row = index / columns, column = index % columns;
  const Eigen::Vector2d place(static_cast<double>(row) + 0.5, static_cast<double>(column) + 0.5);
  return origin() + cell * place;
}

bool BevGrid::contains(const Eigen::Vector2d& place) const {
  const Eigen::Vector2d share = toShare(place);
  return share.minCoeff() >= 0.0 && share.maxCoeff() < 1.0;
}

Eigen::Vector2d BevGrid::toShare(const Eigen::Vector2d& place) const {
  return (place - origin()).cwiseQuotient(Eigen::Vector2d(length(), width()));
}

Eigen::Vector2d BevGrid::fromShare(const Eigen::Vector2d& share) const {
  return origin() + share.cwiseProduct(Eigen::Vector2d(length(), width()));
}

Eigen::Vector2d BevGrid::toCell(const Eigen::Vector2d& place) const {
  const Eigen::Vector2d cells = (place - origin()) / cell;
  return {cells.y() - 0.5, cells.x() - 0.5};
}

inference::SamplingPlan temporalPlan(const BevGrid& grid, const geometry::Pose2d& present,
                                     const geometry::Pose2d& past) {
  inference::SamplingPlan plan;
  plan.queries = grid.cells();
  plan.points = kTemporalPoints;
  for (std::int64_t index = 0; index < grid.cells(); ++index) {
    const Eigen::Vector2d now = grid.center(index);
    const Eigen::Vector2d before = past.toBody(present.toMap(now));
    plan.visit(index, 0, 0);
    addPlace(grid.toCell(before).cast<float>(), kTemporalPoints, plan.references);
    plan.visit(index, 1, 1);
    addPlace(grid.toCell(now).cast<float>(), kTemporalPoints, plan.references);
  }
  plan.finish();
  return plan;
}

inference::SamplingPlan cameraPlan(const BevGrid& grid, const rendering::CameraRig& rig,
                                   std::int64_t stride) {
  inference::SamplingPlan plan;
  plan.queries = grid.cells();
  plan.points = kCameraPoints;
  for (std::int64_t index = 0; index < grid.cells(); ++index) {
    for (std::size_t camera = 0; camera < rig.cameras.size(); ++camera) {
      const rendering::RigCamera& one = rig.cameras[camera];
      const VisiblePillar pillar =
          pillarIn(one, rendering::projectionOf(one), grid.center(index), stride);
      if (!pillar.seen) continue;
      plan.visit(index, static_cast<std::int64_t>(camera));
      for (const Eigen::Vector2f& place : pillar.places)
        addPlace(place, kCameraPoints / kPillarPoints, plan.references);
    }
  }
  plan.finish();
  return plan;
}

}  // namespace cdiff::planners
