// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "rendering/lane_surface.h"

#include <algorithm>
#include <cmath>

namespace cdiff::rendering {
namespace {

constexpr double kLongestMiter = 2.0;  // of the lateral distance
constexpr double kSame = 1e-9;         // [m]

Eigen::Vector2d unitAlong(const geometry::Polyline& line, std::size_t segment) {
  const auto& points = line.points();
  const Eigen::Vector2d along = (points[segment + 1] - points[segment]).head<2>();
  return along / along.norm();
}

/// Left normal at a point of the line; at a bend the bisector, so long that both borders meet.
Eigen::Vector2d leftAtPoint(const geometry::Polyline& line, std::size_t index) {
  const std::size_t last = line.points().size() - 1;
  if (index == 0) return geometry::leftNormal(unitAlong(line, 0));
  if (index == last) return geometry::leftNormal(unitAlong(line, last - 1));
  const Eigen::Vector2d before = unitAlong(line, index - 1);
  const Eigen::Vector2d sum = before + unitAlong(line, index);
  const double length = sum.norm();
  if (length < 1e-6) return geometry::leftNormal(before);
  const Eigen::Vector2d middle = sum / length;
  const double cosine = middle.x() * before.x() + middle.y() * before.y();
  return geometry::leftNormal(middle) / std::max(cosine, 1.0 / kLongestMiter);
}

CrossSection between(const geometry::Polyline& line, std::size_t segment, double arc_length) {
  const double begin = line.arcLengths()[segment];
  const double share = (arc_length - begin) / (line.arcLengths()[segment + 1] - begin);
  CrossSection section;
  section.arc_length = arc_length;
  section.center =
      line.points()[segment] + share * (line.points()[segment + 1] - line.points()[segment]);
  section.left = geometry::leftNormal(unitAlong(line, segment));
  return section;
}

CrossSection sectionAt(const geometry::Polyline& line, double arc_length) {
  const auto& arcs = line.arcLengths();
  const auto after = std::upper_bound(arcs.begin(), arcs.end(), arc_length);
  const auto index = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(
      after - arcs.begin() - 1, 0, static_cast<std::ptrdiff_t>(arcs.size()) - 1));
  if (arc_length - arcs[index] <= kSame || index + 1 == arcs.size()) {
    return {line.points()[index], leftAtPoint(line, index), arcs[index]};
  }
  return between(line, index, arc_length);
}

}  // namespace

std::vector<CrossSection> crossSections(const geometry::Polyline& line, double begin, double end,
                                        double spacing) {
  std::vector<double> stations = {begin};
  const auto add = [&](double arc_length) {
    const double from = stations.back();
    const int pieces = std::max(1, static_cast<int>(std::ceil((arc_length - from) / spacing)));
    for (int i = 1; i < pieces; ++i) stations.push_back(from + (arc_length - from) * i / pieces);
    stations.push_back(arc_length);
  };
  for (const double arc_length : line.arcLengths()) {
    if (arc_length > begin + kSame && arc_length < end - kSame) add(arc_length);
  }
  add(end);
  std::vector<CrossSection> sections;
  for (const double station : stations) sections.push_back(sectionAt(line, station));
  return sections;
}

}  // namespace cdiff::rendering
