// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "rendering/lane_markings.h"

#include <algorithm>
#include <cmath>

#include "rendering/lane_surface.h"

namespace cdiff::rendering {
namespace {

constexpr double kLineWidth = 0.15;    // [m]
constexpr double kInset = 0.12;        // [m] of an edge line's middle from the lane's border
constexpr double kDash = 3.0;          // [m]
constexpr double kDashPeriod = 9.0;    // [m]
constexpr double kPiece = 10.0;        // [m] longest piece of a line
constexpr double kOppositeGap = 0.8;   // [m] between borders of lanes that share a centre line
constexpr double kInside = 0.4;        // [m] a border this far inside another lane is not painted
constexpr double kOpposite = 2.4;      // [rad] smallest heading difference of opposite lanes
constexpr double kShortestLane = 0.5;  // [m]

void paintPiece(const CrossSection& begin, const CrossSection& end, double lateral, Color color,
                std::vector<Marking>& markings) {
  markings.push_back(markingBetween(begin.at(lateral), end.at(lateral), kLineWidth, color));
}

void paintDashes(const map::Lane& lane, double lateral, std::vector<Marking>& markings) {
  const double length = lane.centerline.length();
  for (int i = 0; i * kDashPeriod < length; ++i) {
    const double begin = i * kDashPeriod;
    const auto sections =
        crossSections(lane.centerline, begin, std::min(begin + kDash, length), kPiece);
    for (std::size_t k = 1; k < sections.size(); ++k) {
      paintPiece(sections[k - 1], sections[k], lateral, kWhitePaint, markings);
    }
  }
}

/// `side`: 1 for the left border, -1 for the right one.
void paintBorder(const map::RoadNetwork& network, const map::Lane& lane, double side,
                 std::vector<Marking>& markings) {
  const auto sections = crossSections(lane.centerline, 0.0, lane.centerline.length(), kPiece);
  const double border = side * 0.5 * lane.width;
  for (std::size_t i = 1; i < sections.size(); ++i) {
    const Eigen::Vector3d middle = 0.5 * (sections[i - 1].at(border) + sections[i].at(border));
    const Eigen::Vector3d along = sections[i].center - sections[i - 1].center;
    const Border kind = borderAt(network, lane, middle, std::atan2(along.y(), along.x()));
    if (kind == Border::kNone) continue;
    paintPiece(sections[i - 1], sections[i], border - side * kInset,
               kind == Border::kCenter ? kYellowPaint : kWhitePaint, markings);
  }
}

}  // namespace

Border borderAt(const map::RoadNetwork& network, const map::Lane& lane,
                const Eigen::Vector3d& point, double heading) {
  Border border = Border::kEdge;
  for (const map::LaneMatch& match :
       network.lanesNear(point.head<2>(), point.z(), 4.0, heading, 1.5)) {
    const map::Lane& other = network.lane(match.lane);
    if (other.edge_id == lane.edge_id) continue;
    const double gap = match.projection.distance - 0.5 * other.width;
    if (gap < -kInside) return Border::kNone;
    if (!other.internal && gap < kOppositeGap && std::abs(match.heading_difference) > kOpposite) {
      border = Border::kCenter;
    }
  }
  return border;
}

std::vector<Marking> laneMarkings(const map::RoadNetwork& network) {
  std::vector<Marking> markings;
  for (const map::Lane& lane : network.lanes()) {
    if (lane.internal || !lane.allows_cars || lane.centerline.length() < kShortestLane) continue;
    if (lane.right == map::kNoLane) paintBorder(network, lane, -1.0, markings);
    if (lane.left == map::kNoLane) {
      paintBorder(network, lane, 1.0, markings);
    } else {
      paintDashes(lane, 0.5 * lane.width, markings);
    }
  }
  return markings;
}

}  // namespace cdiff::rendering
