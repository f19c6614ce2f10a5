// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/geometry/shapes.h"
#include "e2e_cdiff/rendering/camera_rig.h"
#include "inference/deformable_attention.h"

namespace cdiff::planners {

/// The bird's-eye view as cells in the ego's body frame (x forward, y left [m]): row r, column c is
/// cell r x columns + c, centered at ((r + 1/2) cell - behind, (c + 1/2 - columns / 2) cell).
struct BevGrid {
  std::int64_t rows = 40;     ///< along x
  std::int64_t columns = 20;  ///< along y
  double cell = 1.5;          ///< side of a cell [m]
  double behind = 12.0;       ///< how far the view reaches behind the ego's center [m]

  void describe(core::OptionsVisitor& visitor);
  std::int64_t cells() const { return rows * columns; }
  inference::MapGrid grid() const { return {rows, columns}; }
  double length() const { return cell * static_cast<double>(rows); }    ///< along x [m]
  double width() const { return cell * static_cast<double>(columns); }  ///< along y [m]
  /// The corner with the smallest coordinates [m].
  Eigen::Vector2d origin() const { return {-behind, -0.5 * width()}; }
  Eigen::Vector2d center(std::int64_t index) const;
  bool contains(const Eigen::Vector2d& place) const;
  /// A place as shares of length and width, and back.
  Eigen::Vector2d toShare(const Eigen::Vector2d& place) const;
  Eigen::Vector2d fromShare(const Eigen::Vector2d& share) const;
  /// (column, row) of a place in cells, as SamplingPlan counts them.
  Eigen::Vector2d toCell(const Eigen::Vector2d& place) const;
};

/// Where the cells of the present BEV (map 1) lie in the past one (map 0), with 4 points each.
/// `present` and `past`: poses of the ego then (map frame). Published code shifts the present's
/// references, too; ours does not.
inference::SamplingPlan temporalPlan(const BevGrid& grid, const geometry::Pose2d& present,
                                     const geometry::Pose2d& past);

/// Which cells see which cameras (map = camera): where a height of the cell's pillar lies in the
/// image. Maps have a cell for each `stride` x `stride` pixels.
inference::SamplingPlan cameraPlan(const BevGrid& grid, const rendering::CameraRig& rig,
                                   std::int64_t stride);

}  // namespace cdiff::planners
