// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "guidance/right_of_way.h"

#include <algorithm>
#include <cmath>

namespace cdiff::guidance {
namespace {

constexpr double kSpacing = 0.5;  // of the boxes along a route [m]
constexpr double kHorizon = 3.2;  // [s]
constexpr double kMargin = 0.5;   // [s]
constexpr Gaps kHalfGaps{0.5, 0.15};

bool meet(const geometry::OrientedBox& first, const geometry::OrientedBox& second) {
  const double near =
      0.5 * (std::hypot(first.length, first.width) + std::hypot(second.length, second.width));
  return (first.center - second.center).squaredNorm() <= near * near &&
         geometry::overlap(first, second);
}

/// Who waits, of two whose strips meet.
struct Waiting {
  bool first = false;
  bool second = false;
};

/// Of two that are in each other's way.
Waiting amongBoth(const RoutedVehicle& first, const RoutedVehicle& second) {
  constexpr double kFacing = 0.5;  // length of the sum of directions: 151 degrees apart
  const Eigen::Vector2d mean =
      geometry::direction(first.state.heading) + geometry::direction(second.state.heading);
  if (mean.norm() < kFacing) return {true, true};
  const bool second_ahead = mean.dot(second.state.position - first.state.position) > 0.0;
  return {second_ahead, !second_ahead};
}

/// `first_way`, `second_way`: of each to the other's strip [m].
Waiting whoWaits(const RoutedVehicle& first, double first_way, const RoutedVehicle& second,
                 double second_way) {
  constexpr double kSlowest = 0.1;  // that ways are divided by at least [m/s]
  if (first_way <= 0.0 && second_way <= 0.0) return amongBoth(first, second);
  if (first_way <= 0.0 || second_way <= 0.0) return {second_way <= 0.0, first_way <= 0.0};
  const double first_time = first_way / std::max(first.state.speed, kSlowest);
  const double second_time = second_way / std::max(second.state.speed, kSlowest);
  const bool second_goes = std::abs(first_time - second_time) <= kMargin ? second.id < first.id
                                                                         : second_time < first_time;
  return {second_goes, !second_goes};
}

}  // namespace

geometry::OrientedBox boxOf(const geometry::Pose2d& pose,
                            const traffic::VehicleDimensions& dimensions, const Gaps& gaps) {
  return {pose.position, pose.heading, dimensions.length + 2.0 * gaps.longitudinal,
          dimensions.width + 2.0 * gaps.lateral};
}

void Stretch::add(double arc_length) {
  begin = std::min(begin, arc_length);
  end = std::max(end, arc_length);
}

RouteStrip::RouteStrip(const RoutedVehicle& vehicle, const Gaps& gaps, double time)
    : start_(vehicle.arc_length) {
  const geometry::Polyline& path = vehicle.route->path();
  const double offset = path.extendedPoseAt(start_).toBody(vehicle.state.position).y();
  const double fastest = std::max(vehicle.state.speed, vehicle.target_speed);
  const double reach = fastest * time + vehicle.dimensions.length;
  for (double ahead = 0.0; ahead < reach; ahead += kSpacing) {
    const geometry::Pose2d pose = path.extendedPoseAt(start_ + ahead);
    boxes_.push_back(boxOf({pose.toMap({0.0, offset}), pose.heading}, vehicle.dimensions, gaps));
  }
}

Stretch RouteStrip::meeting(const geometry::OrientedBox& other) const {
  Stretch met;
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    if (meet(boxes_[i], other)) met.add(start_ + kSpacing * static_cast<double>(i));
  }
  return met;
}

Stretch RouteStrip::meeting(const RouteStrip& other) const {
  Stretch met;
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    const auto meets = [&](const geometry::OrientedBox& box) { return meet(boxes_[i], box); };
    if (std::any_of(other.boxes_.begin(), other.boxes_.end(), meets))
      met.add(start_ + kSpacing * static_cast<double>(i));
  }
  return met;
}

RightOfWay::RightOfWay(const std::vector<RoutedVehicle>& vehicles) {
  std::vector<RouteStrip> strips;
  for (const RoutedVehicle& vehicle : vehicles) strips.emplace_back(vehicle, kHalfGaps, kHorizon);
  for (std::size_t i = 0; i < vehicles.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Stretch first = strips[i].meeting(strips[j]);
      const Stretch second = strips[j].meeting(strips[i]);
      if (first.empty() || second.empty()) continue;
      const Waiting waiting = whoWaits(vehicles[i], first.begin - vehicles[i].arc_length,
                                       vehicles[j], second.begin - vehicles[j].arc_length);
      if (waiting.first) waits_.emplace_back(vehicles[i].id, vehicles[j].id);
      if (waiting.second) waits_.emplace_back(vehicles[j].id, vehicles[i].id);
    }
  }
  std::sort(waits_.begin(), waits_.end());
}

bool RightOfWay::mayGo(const std::string& first, const std::string& second) const {
  return !std::binary_search(waits_.begin(), waits_.end(), std::make_pair(first, second));
}

}  // namespace cdiff::guidance
