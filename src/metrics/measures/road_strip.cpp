// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/measures/road_strip.h"

#include <algorithm>
#include <cmath>

namespace cdiff::metrics {
namespace {

/// Of the circle around a box [m].
double radiusOf(const geometry::OrientedBox& box) {
  return 0.5 * std::hypot(box.length, box.width);
}

}  // namespace

std::vector<geometry::OrientedBox> stripAlong(const geometry::Polyline& line, double begin,
                                              double end, double width) {
  constexpr double kPiece = 2.0;  // [m]
  begin = std::max(begin, 0.0);
  end = std::min(end, line.length());
  std::vector<geometry::OrientedBox> strip;
  if (!(end > begin)) return strip;
  const int pieces = static_cast<int>(std::ceil((end - begin) / kPiece));
  Eigen::Vector2d from = line.positionAt(begin);
  for (int i = 1; i <= pieces; ++i) {
    const Eigen::Vector2d to = line.positionAt(begin + (end - begin) * i / pieces);
    const Eigen::Vector2d chord = to - from;
    strip.push_back({0.5 * (from + to), std::atan2(chord.y(), chord.x()), chord.norm(), width});
    from = to;
  }
  return strip;
}

bool overlapsStrip(const geometry::OrientedBox& box,
                   const std::vector<geometry::OrientedBox>& strip) {
  const double radius = radiusOf(box);
  return std::any_of(strip.begin(), strip.end(), [&](const geometry::OrientedBox& piece) {
    const double reach = radius + radiusOf(piece);
    return (piece.center - box.center).squaredNorm() <= reach * reach && overlap(piece, box);
  });
}

}  // namespace cdiff::metrics
