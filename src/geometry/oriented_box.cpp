// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/geometry/oriented_box.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cdiff::geometry {

double halfExtent(const OrientedBox& box, const Eigen::Vector2d& axis) {
  const Eigen::Vector2d forward = direction(box.heading);
  return 0.5 * (box.length * std::abs(forward.dot(axis)) +
                box.width * std::abs(leftNormal(forward).dot(axis)));
}

namespace {

bool separates(const Eigen::Vector2d& axis, const OrientedBox& first, const OrientedBox& second) {
  const double gap = std::abs((second.center - first.center).dot(axis));
  return gap > halfExtent(first, axis) + halfExtent(second, axis);
}

double pointToBox(const Eigen::Vector2d& point, const OrientedBox& box) {
  const Eigen::Vector2d body = Pose2d{box.center, box.heading}.toBody(point);
  const double outside_x = std::max(0.0, std::abs(body.x()) - 0.5 * box.length);
  const double outside_y = std::max(0.0, std::abs(body.y()) - 0.5 * box.width);
  return std::hypot(outside_x, outside_y);
}

}  // namespace

std::array<Eigen::Vector2d, 4> OrientedBox::corners() const {
  const Pose2d pose{center, heading};
  const double x = 0.5 * length;
  const double y = 0.5 * width;
  return {pose.toMap({x, y}), pose.toMap({x, -y}), pose.toMap({-x, -y}), pose.toMap({-x, y})};
}

bool OrientedBox::contains(const Eigen::Vector2d& point) const {
  return pointToBox(point, *this) == 0.0;
}

bool overlap(const OrientedBox& first, const OrientedBox& second) {
  for (const OrientedBox* box : {&first, &second}) {
    const Eigen::Vector2d forward = direction(box->heading);
    if (separates(forward, first, second)) return false;
    if (separates(leftNormal(forward), first, second)) return false;
  }
  return true;
}

double distance(const OrientedBox& first, const OrientedBox& second) {
  if (overlap(first, second)) return 0.0;
  double nearest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector2d& corner : first.corners()) {
    nearest = std::min(nearest, pointToBox(corner, second));
  }
  for (const Eigen::Vector2d& corner : second.corners()) {
    nearest = std::min(nearest, pointToBox(corner, first));
  }
  return nearest;
}

}  // namespace cdiff::geometry
