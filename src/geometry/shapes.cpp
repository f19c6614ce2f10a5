// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/geometry/shapes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::geometry {
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

double halfExtent(const OrientedBox& box, const Eigen::Vector2d& axis) {
  const Eigen::Vector2d forward = direction(box.heading);
  return 0.5 * (box.length * std::abs(forward.dot(axis)) +
                box.width * std::abs(leftNormal(forward).dot(axis)));
}

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

Polyline::Polyline(const std::vector<Eigen::Vector3d>& points) {
  constexpr double kMergeDistance = 1e-3;
  for (const Eigen::Vector3d& point : points) {
    if (!point.allFinite()) throw core::InputError("a line has a non-finite coordinate");
    const double step = points_.empty() ? 0.0 : (point - points_.back()).head<2>().norm();
    if (!points_.empty() && step < kMergeDistance) continue;
    arc_lengths_.push_back(points_.empty() ? 0.0 : arc_lengths_.back() + step);
    points_.push_back(point);
  }
  if (points_.size() < 2) throw core::InputError("a line needs at least two distinct points");
}

std::size_t Polyline::segmentAt(double arc_length) const {
  const auto above = std::upper_bound(arc_lengths_.begin(), arc_lengths_.end(), arc_length);
  const auto index = static_cast<std::ptrdiff_t>(above - arc_lengths_.begin()) - 1;
  const auto last = static_cast<std::ptrdiff_t>(points_.size()) - 2;
  return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(index, 0, last));
}

Eigen::Vector3d Polyline::pointAt(double arc_length) const {
  const double clamped = std::clamp(arc_length, 0.0, length());
  const std::size_t i = segmentAt(clamped);
  const double fraction = (clamped - arc_lengths_[i]) / (arc_lengths_[i + 1] - arc_lengths_[i]);
  return points_[i] + fraction * (points_[i + 1] - points_[i]);
}

double Polyline::headingAt(double arc_length) const {
  const std::size_t i = segmentAt(arc_length);
  const Eigen::Vector3d along = points_[i + 1] - points_[i];
  return std::atan2(along.y(), along.x());
}

Pose2d Polyline::extendedPoseAt(double arc_length) const {
  const double inside = std::clamp(arc_length, 0.0, length());
  const double heading = headingAt(inside);
  return {positionAt(inside) + (arc_length - inside) * direction(heading), heading};
}

Projection Polyline::project(const Eigen::Vector2d& point) const {
  return project(point, 0.0, length());
}

Projection Polyline::project(const Eigen::Vector2d& point, double begin, double end) const {
  const std::size_t first = segmentAt(begin);
  const std::size_t last = segmentAt(end);
  Projection best;
  double best_squared = std::numeric_limits<double>::infinity();
  std::size_t best_segment = first;
  for (std::size_t i = first; i <= last; ++i) {
    const Eigen::Vector2d start = points_[i].head<2>();
    const double segment_length = arc_lengths_[i + 1] - arc_lengths_[i];
    const Eigen::Vector2d along = (points_[i + 1].head<2>() - start) / segment_length;
    const double low = std::max(begin, arc_lengths_[i]) - arc_lengths_[i];
    const double high = std::max(low, std::min(end, arc_lengths_[i + 1]) - arc_lengths_[i]);
    const double distance_along = std::clamp(along.dot(point - start), low, high);
    const double squared = (start + along * distance_along - point).squaredNorm();
    if (squared >= best_squared) continue;
    best_squared = squared;
    best_segment = i;
    best.arc_length = arc_lengths_[i] + distance_along;
    best.lateral_offset = cross(along, point - start);
  }
  best.distance = std::sqrt(best_squared);
  if (std::abs(best.lateral_offset) < best.distance) {
    best.lateral_offset = best.lateral_offset < 0.0 ? -best.distance : best.distance;
  }
  best.elevation = pointAt(best.arc_length).z();
  const Eigen::Vector3d along = points_[best_segment + 1] - points_[best_segment];
  best.heading = std::atan2(along.y(), along.x());
  return best;
}

std::pair<double, double> Polyline::around(double arc_length, const SearchWindow& window) const {
  return {std::clamp(arc_length - window.behind, 0.0, length()),
          std::clamp(arc_length + window.ahead, 0.0, length())};
}

Projection Polyline::projectNear(const Eigen::Vector2d& point, double arc_length,
                                 const SearchWindow& window) const {
  const auto [begin, end] = around(arc_length, window);
  return project(point, begin, end);
}

Polyline Polyline::slice(double begin, double end) const {
  std::vector<Eigen::Vector3d> part = {pointAt(begin)};
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (arc_lengths_[i] > begin && arc_lengths_[i] < end) part.push_back(points_[i]);
  }
  part.push_back(pointAt(end));
  return Polyline(part);
}

std::vector<Eigen::Vector3d> Polyline::resampled(double spacing) const {
  std::vector<Eigen::Vector3d> samples;
  const auto count = static_cast<std::size_t>(std::floor(length() / spacing + 1e-9));
  for (std::size_t i = 0; i <= count; ++i)
    samples.push_back(pointAt(static_cast<double>(i) * spacing));
  if ((samples.back() - points_.back()).head<2>().norm() > 1e-3) samples.push_back(points_.back());
  return samples;
}

}  // namespace cdiff::geometry
