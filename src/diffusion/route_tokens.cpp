// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "diffusion/route_tokens.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace cdiff::diffusion {
namespace {

/// Point of the path, which goes straight on beyond its end.
Eigen::Vector2d pointAhead(const geometry::Polyline& path, double arc_length) {
  const double beyond = std::max(0.0, arc_length - path.length());
  return path.positionAt(arc_length) + beyond * geometry::direction(path.headingAt(path.length()));
}

}  // namespace

std::vector<float> routeTokens(const Architecture& architecture, const geometry::Polyline& path,
                               double arc_length, const geometry::Pose2d& pose) {
  if (path.empty()) throw std::invalid_argument("routeTokens: the path is empty");
  std::vector<float> tokens;
  tokens.reserve(static_cast<std::size_t>(2 * architecture.route_points));
  for (std::int64_t i = 1; i <= architecture.route_points; ++i) {
    const double ahead = arc_length + static_cast<double>(i) * architecture.route_spacing;
    const Eigen::Vector2d token = pose.toBody(pointAhead(path, ahead)) / kRouteTokenScale;
    tokens.push_back(static_cast<float>(token.x()));
    tokens.push_back(static_cast<float>(token.y()));
  }
  return tokens;
}

}  // namespace cdiff::diffusion
