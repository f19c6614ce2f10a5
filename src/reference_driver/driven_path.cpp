// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "reference_driver/driven_path.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"

namespace cdiff::reference_driver {
namespace {

constexpr double kSpacing = 1.0;  // of the points [m]
constexpr double kBehind = 30.0;  // [m]

}  // namespace

DrivenPath::DrivenPath(const geometry::Polyline& line, double arc_length, double ahead)
    : start_(arc_length - kBehind) {
  const auto count = static_cast<std::size_t>(std::ceil((kBehind + ahead) / kSpacing)) + 1;
  poses_.reserve(count);
  for (std::size_t i = 0; i < count; ++i)
    poses_.push_back(line.extendedPoseAt(start_ + static_cast<double>(i) * kSpacing));
}

geometry::Pose2d DrivenPath::poseAt(double arc_length) const {
  const auto last = static_cast<double>(poses_.size() - 1);
  const double place = std::clamp((arc_length - start_) / kSpacing, 0.0, last);
  const auto index = std::min(static_cast<std::size_t>(place), poses_.size() - 2);
  const double share = place - static_cast<double>(index);
  const geometry::Pose2d& from = poses_[index];
  const geometry::Pose2d& to = poses_[index + 1];
  return {from.position + share * (to.position - from.position),
          from.heading + share * core::angleDifference(to.heading, from.heading)};
}

geometry::OrientedBox DrivenPath::boxOf(const OwnMotion& own) const {
  const geometry::Pose2d pose = poseAt(own.arc_length);
  return {pose.toMap({0.0, own.offset}), pose.heading, own.dimensions.length, own.dimensions.width};
}

std::size_t DrivenPath::nearest(const Eigen::Vector2d& place,
                                std::optional<std::size_t> hint) const {
  const auto distance = [&](std::size_t i) { return (poses_[i].position - place).squaredNorm(); };
  if (!hint) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < poses_.size(); ++i) {
      if (distance(i) < distance(best)) best = i;
    }
    return best;
  }
  std::size_t best = *hint;
  while (best + 1 < poses_.size() && distance(best + 1) < distance(best)) ++best;
  while (best > 0 && distance(best - 1) < distance(best)) --best;
  return best;
}

std::optional<SeenVehicle> DrivenPath::see(const traffic::VehicleState& state,
                                           const traffic::VehicleDimensions& dimensions,
                                           std::optional<std::size_t>& hint) const {
  hint = nearest(state.position, hint);
  if (*hint == 0 || *hint + 1 == poses_.size()) return std::nullopt;
  const geometry::Pose2d& pose = poses_[*hint];
  const Eigen::Vector2d place = pose.toBody(state.position);
  const Eigen::Vector2d heading =
      geometry::direction(core::angleDifference(state.heading, pose.heading));
  SeenVehicle seen;
  seen.arc_length = start_ + static_cast<double>(*hint) * kSpacing + place.x();
  seen.offset = place.y();
  seen.along_speed = state.speed * heading.x();
  seen.across_speed = state.speed * heading.y();
  const double along = std::abs(heading.x());
  const double across = std::abs(heading.y());
  seen.half_along = 0.5 * (along * dimensions.length + across * dimensions.width);
  seen.half_across = 0.5 * (across * dimensions.length + along * dimensions.width);
  return seen;
}

}  // namespace cdiff::reference_driver
