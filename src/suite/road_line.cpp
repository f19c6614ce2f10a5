// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "suite/road_line.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/geometry/polyline.h"

namespace cdiff::suite {

RoadLine::RoadLine(const Eigen::Vector2d& start, double heading)
    : position_(start), heading_(heading), points_{{start.x(), start.y(), 0.0}} {}

RoadLine& RoadLine::straight(double length) {
  constexpr double kSpacing = 5.0;  // [m]
  const int pieces = std::max(1, static_cast<int>(std::ceil(length / kSpacing)));
  const Eigen::Vector2d start = position_;
  for (int i = 1; i <= pieces; ++i) {
    position_ = start + length * i / pieces * geometry::direction(heading_);
    points_.emplace_back(position_.x(), position_.y(), 0.0);
  }
  return *this;
}

RoadLine& RoadLine::arc(double radius, double angle) {
  const int pieces = std::max(3, static_cast<int>(std::ceil(radius * std::abs(angle))));
  const double side = angle > 0.0 ? 1.0 : -1.0;
  const Eigen::Vector2d start = position_;
  const Eigen::Vector2d forward = geometry::direction(heading_);
  const Eigen::Vector2d left(-forward.y(), forward.x());
  for (int i = 1; i <= pieces; ++i) {
    const double turned = std::abs(angle) * i / pieces;
    position_ = start + radius * std::sin(turned) * forward +
                side * radius * (1.0 - std::cos(turned)) * left;
    points_.emplace_back(position_.x(), position_.y(), 0.0);
  }
  heading_ += angle;
  return *this;
}

Line beside(const Line& line, double offset) {
  Line moved;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const Eigen::Vector3d& before = line[i == 0 ? 0 : i - 1];
    const Eigen::Vector3d& after = line[std::min(i + 1, line.size() - 1)];
    const Eigen::Vector2d forward = (after - before).head<2>().normalized();
    moved.emplace_back(line[i].x() - offset * forward.y(), line[i].y() + offset * forward.x(),
                       line[i].z());
  }
  return moved;
}

Line reversed(Line line) {
  std::reverse(line.begin(), line.end());
  return line;
}

Line climbing(Line line, double begin, double height) {
  const geometry::Polyline path(line);
  for (std::size_t i = 0; i < line.size(); ++i) {
    const double share = (path.arcLengths()[i] - begin) / (path.length() - begin);
    const double u = std::clamp(share, 0.0, 1.0);
    line[i].z() = height * u * u * (3.0 - 2.0 * u);
  }
  return line;
}

Line part(const Line& line, double begin, double end) {
  return geometry::Polyline(line).slice(begin, end).points();
}

double lengthOf(const Line& line) { return geometry::Polyline(line).length(); }

}  // namespace cdiff::suite
