// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/simulation/settling_motion.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/simulation/sumo_conversion.h"

namespace cdiff::simulation {

namespace {

constexpr double kPathLength = 150.0;      ///< ahead [m]
constexpr double kShortestReach = 3.0;     ///< along which the offset decays [m]
constexpr double kReachTime = 0.8;         ///< the same at speed [s]
constexpr double kLargestCurvature = 0.2;  ///< of the vehicle against the path [1/m]
constexpr double kSettledOffset = 0.02;    ///< [m]
constexpr double kSettledHeading = 0.01;   ///< [rad]

/// The lane that follows `lane` towards the next edge of the way; kNoLane where another lane is
/// needed.
map::LaneIndex nextLane(const EdgeGraph& graph, map::LaneIndex lane, const std::vector<int>& way) {
  const auto here = std::find(way.begin(), way.end(), graph.edgeOf(lane));
  if (here == way.end() || here + 1 == way.end()) return map::kNoLane;
  for (const map::LaneLink& link : graph.network().lane(lane).next) {
    if (graph.edgeAfter(link.to) == *(here + 1)) return link.to;
  }
  return map::kNoLane;
}

geometry::Polyline pathFrom(const EdgeGraph& graph, map::LaneIndex lane,
                            const std::vector<int>& way) {
  const map::RoadNetwork& network = graph.network();
  std::vector<Eigen::Vector3d> points;
  if (!network.lane(lane).previous.empty()) {
    points = network.lane(network.lane(lane).previous.front()).centerline.points();
  }
  double length = -network.lane(lane).centerline.length();
  while (lane != map::kNoLane && length < kPathLength) {
    const geometry::Polyline& line = network.lane(lane).centerline;
    points.insert(points.end(), line.points().begin(), line.points().end());
    length += line.length();
    lane = nextLane(graph, lane, way);
  }
  return geometry::Polyline(points);
}

}  // namespace

SettlingMotion::SettlingMotion(const EdgeGraph& graph, map::LaneIndex lane,
                               const std::vector<int>& way, const traffic::VehicleState& state,
                               double length)
    : path_(pathFrom(graph, lane, way)), length_(length), state_(state) {
  const geometry::Projection front = path_.project(frontOf(state.pose(), length));
  arc_length_ = front.arc_length;
  offset_ = front.lateral_offset;
  heading_error_ = core::angleDifference(state.heading, headingAt(arc_length_));
}

double SettlingMotion::headingAt(double arc_length) const {
  if (arc_length <= length_) return path_.headingAt(arc_length);
  const Eigen::Vector2d chord =
      path_.positionAt(arc_length) - path_.positionAt(arc_length - length_);
  return std::atan2(chord.y(), chord.x());
}

const traffic::VehicleState& SettlingMotion::advance(double speed, double step) {
  const double reach = std::max(kShortestReach, kReachTime * speed);
  const double wanted = -offset_ / (reach * reach) - 2.0 * heading_error_ / reach;
  const double curvature = std::clamp(wanted, -kLargestCurvature, kLargestCurvature);
  heading_error_ += speed * step * curvature;
  offset_ += speed * step * std::sin(heading_error_);
  arc_length_ = std::min(arc_length_ + speed * step * std::cos(heading_error_), path_.length());
  state_.speed = speed;
  const Eigen::Vector3d point = path_.pointAt(arc_length_);
  const double along = headingAt(arc_length_);
  state_.heading = core::wrapAngle(along + heading_error_);
  const Eigen::Vector2d front =
      point.head<2>() +
      offset_ * geometry::leftNormal(geometry::direction(path_.headingAt(arc_length_)));
  state_.position = centerBehind(front, state_.heading, length_);
  state_.elevation = point.z();
  return state_;
}

bool SettlingMotion::settled() const {
  const bool aligned =
      std::abs(offset_) < kSettledOffset && std::abs(heading_error_) < kSettledHeading;
  return aligned || arc_length_ >= path_.length() - 0.5;
}

}  // namespace cdiff::simulation
