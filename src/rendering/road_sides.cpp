// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "rendering/road_sides.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rendering/lane_markings.h"
#include "rendering/lane_surface.h"

namespace cdiff::rendering {
namespace {

constexpr double kPiece = 10.0;         // [m] along the lane
constexpr double kMostHeight = 12.0;    // [m] a slope goes at most this far down
constexpr double kLeastHeight = 0.4;    // [m] lower roads lie on the ground
constexpr double kSlope = 1.5;          // [m] outwards per metre down
constexpr double kBeside = 0.2;         // [m] from the lane's border; on the asphalt's margin
constexpr double kClear = 1.5;          // [m] between a slope and a lower road
constexpr double kDeckThickness = 0.9;  // [m]
constexpr double kWidestHalf = 3.0;     // [m] of a lane
constexpr double kLowerRoad = 2.0;      // [m] a road this far below is in the way of a slope
constexpr double kSlopeRank = 0.95;

/// Whether no lower road is in the way of a slope from `point` down by `drop`.
bool slopeFits(const map::RoadNetwork& network, const Eigen::Vector3d& point, double drop) {
  const double reach = kSlope * drop + kClear;
  for (const map::LaneMatch& match : network.lanesNear(point.head<2>(), reach + kWidestHalf)) {
    const double free = match.projection.distance - 0.5 * network.lane(match.lane).width;
    if (free < reach && match.projection.elevation < point.z() - kLowerRoad) return false;
  }
  return true;
}

Eigen::Vector3d lowered(Eigen::Vector3d point, double height) {
  point.z() -= height;
  return point;
}

/// The piece between two cross-sections, at the border `lateral` metres to the left.
Surface slopePiece(const CrossSection& begin, const CrossSection& end, double lateral,
                   double drop) {
  const double outer = lateral + (lateral > 0.0 ? 1.0 : -1.0) * kSlope * drop;
  Surface side;
  side.corners = {begin.at(lateral), end.at(lateral), lowered(end.at(outer), drop),
                  lowered(begin.at(outer), drop)};
  side.color = kGrassSlope;
  side.rank = kSlopeRank;
  side.two_sided = true;
  return side;
}

Surface deckPiece(const CrossSection& begin, const CrossSection& end, double lateral) {
  Surface side;
  side.corners = {begin.at(lateral), end.at(lateral), lowered(end.at(lateral), kDeckThickness),
                  lowered(begin.at(lateral), kDeckThickness)};
  side.color = kConcrete;
  side.two_sided = true;
  return side;
}

void addBorder(const map::RoadNetwork& network, const map::Lane& lane, double side, double ground,
               std::vector<Surface>& surfaces) {
  const auto sections = crossSections(lane.centerline, 0.0, lane.centerline.length(), kPiece);
  const double border = side * 0.5 * lane.width;
  for (std::size_t i = 1; i < sections.size(); ++i) {
    const Eigen::Vector3d middle = 0.5 * (sections[i - 1].at(border) + sections[i].at(border));
    const double drop = std::min(middle.z() - ground, kMostHeight);
    if (drop < kLeastHeight) continue;
    const Eigen::Vector3d along = sections[i].center - sections[i - 1].center;
    if (borderAt(network, lane, middle, std::atan2(along.y(), along.x())) != Border::kEdge)
      continue;
    const double lateral = border + side * kBeside;
    surfaces.push_back(slopeFits(network, middle, drop)
                           ? slopePiece(sections[i - 1], sections[i], lateral, drop)
                           : deckPiece(sections[i - 1], sections[i], lateral));
  }
}

double lowestRoad(const map::RoadNetwork& network) {
  double low = std::numeric_limits<double>::infinity();
  for (const map::Lane& lane : network.lanes()) {
    for (const Eigen::Vector3d& point : lane.centerline.points()) low = std::min(low, point.z());
  }
  return low;
}

}  // namespace

std::vector<Surface> roadSides(const map::RoadNetwork& network) {
  std::vector<Surface> surfaces;
  const double ground = lowestRoad(network);
  for (const map::Lane& lane : network.lanes()) {
    if (lane.internal || !lane.allows_cars || lane.centerline.length() < kLeastHeight) continue;
    if (lane.right == map::kNoLane) addBorder(network, lane, -1.0, ground, surfaces);
    if (lane.left == map::kNoLane) addBorder(network, lane, 1.0, ground, surfaces);
  }
  return surfaces;
}

}  // namespace cdiff::rendering
