// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Triangles of a simple polygon by cutting ears off, in the plane; heights are kept.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace cdiff::rendering {

/// Triangles that fill the outline (either turning direction); a rest that is not simple is filled
/// as a fan.
std::vector<std::array<Eigen::Vector3d, 3>> triangulate(std::vector<Eigen::Vector3d> outline);

}  // namespace cdiff::rendering
