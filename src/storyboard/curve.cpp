// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "storyboard/curve.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"

namespace cdiff::storyboard {
namespace {

/// A point times its weight, and the weight.
using Weighted = Eigen::Matrix<double, 5, 1>;

/// The point at a parameter (de Boor's algorithm).
TimedPoint pointAt(const Spline& spline, const std::vector<Weighted>& controls, double parameter) {
  const std::size_t degree = spline.order - 1;
  const auto& knots = spline.knots;
  const auto first = knots.begin() + static_cast<std::ptrdiff_t>(degree + 1);
  const auto last = knots.begin() + static_cast<std::ptrdiff_t>(controls.size());
  const std::size_t span =
      degree + static_cast<std::size_t>(std::upper_bound(first, last, parameter) - first);
  std::vector<Weighted> points(controls.begin() + static_cast<std::ptrdiff_t>(span - degree),
                               controls.begin() + static_cast<std::ptrdiff_t>(span + 1));
  for (std::size_t round = 1; round <= degree; ++round) {
    for (std::size_t j = degree; j >= round; --j) {
      const std::size_t i = j + span - degree;
      const double width = knots[i + degree + 1 - round] - knots[i];
      const double share = width > 0.0 ? (parameter - knots[i]) / width : 0.0;
      points[j] = (1.0 - share) * points[j - 1] + share * points[j];
    }
  }
  return points[degree].head<4>() / points[degree][4];
}

}  // namespace

std::vector<MapPose> placesAlong(const Clothoid& curve, const MapPose& start) {
  constexpr double kStep = 0.5;  // [m]
  const int steps = std::max(1, static_cast<int>(std::ceil(curve.length / kStep)));
  const double step = curve.length / steps;
  const auto heading = [&](double s) {
    return start.pose.heading + s * (curve.curvature + 0.5 * s * curve.change);
  };
  std::vector<MapPose> places = {start};
  for (int i = 1; i <= steps; ++i) {
    MapPose next = places.back();
    const double s = i * step;
    next.pose.position += step * geometry::direction(heading(s - 0.5 * step));
    next.pose.heading = core::wrapAngle(heading(s));
    places.push_back(next);
  }
  return places;
}

std::vector<TimedPoint> pointsAlong(const Spline& spline, const std::vector<TimedPoint>& controls) {
  constexpr std::size_t kEach = 20;  // points for each control point
  std::vector<Weighted> weighted(controls.size());
  for (std::size_t i = 0; i < controls.size(); ++i)
    weighted[i] << spline.weights[i] * controls[i], spline.weights[i];
  const double begin = spline.knots[spline.order - 1];
  const double end = spline.knots[controls.size()];
  const std::size_t count = kEach * controls.size();
  std::vector<TimedPoint> points;
  for (std::size_t i = 0; i <= count; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(count);
    points.push_back(pointAt(spline, weighted, begin + share * (end - begin)));
  }
  return points;
}

}  // namespace cdiff::storyboard
