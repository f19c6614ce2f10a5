// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <vector>

namespace cdiff::geometry {

/// The line without points that lie nearer than `tolerance` [m] to it (Douglas and Peucker 1973).
std::vector<Eigen::Vector2d> simplified(const std::vector<Eigen::Vector2d>& line, double tolerance);

}  // namespace cdiff::geometry
