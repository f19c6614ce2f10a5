// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "road_sides.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lane_markings.h"
#include "lane_surface.h"

namespace cdiff::rendering {
namespace {

constexpr double kPiece = 10.0;         // [m] along the lane
constexpr double kSearch = 40.0;        // [m] the lowest road within it is the ground's height
constexpr double kLeastHeight = 0.4;    // [m] lower roads lie on the ground
constexpr double kSlope = 1.5;          // [m] outwards per metre down
constexpr double kBeside = 0.2;         // [m] from the lane's border; on the asphalt's margin
constexpr double kClear = 1.5;          // [m] between a slope and a lower road
constexpr double kDeckThickness = 0.9;  // [m]
constexpr double kSlopeRank = 0.95;

struct Surroundings {
  double ground = 0.0;     ///< elevation of the lowest road near [m]
  bool slope_fits = true;  ///< no lower road in the way of a slope
};

Surroundings surroundingsOf(const map::RoadNetwork& network, const Eigen::Vector3d& point) {
  Surroundings found;
  found.ground = point.z();
  const auto matches = network.lanesNear(point.head<2>(), kSearch);
  for (const map::LaneMatch& match : matches) {
    found.ground = std::min(found.ground, match.projection.elevation);
  }
  const double reach = kSlope * (point.z() - found.ground) + kClear;
  for (const map::LaneMatch& match : matches) {
    const double free = match.projection.distance - 0.5 * network.lane(match.lane).width;
    // The lane itself slopes too: only what lies clearly below is in the way.
    if (free < reach && match.projection.elevation < point.z() - 2.0) found.slope_fits = false;
  }
  return found;
}

Eigen::Vector3d lowered(Eigen::Vector3d point, double height) {
  point.z() -= height;
  return point;
}

/// The piece between two cross-sections, at the border `lateral` metres to the left.
void addPiece(const CrossSection& begin, const CrossSection& end, double lateral,
              const Surroundings& around, std::vector<Surface>& surfaces) {
  const double drop = 0.5 * (begin.center.z() + end.center.z()) - around.ground;
  Surface side;
  const Eigen::Vector3d first = begin.at(lateral);
  const Eigen::Vector3d second = end.at(lateral);
  if (around.slope_fits) {
    const double outer = lateral + (lateral > 0.0 ? 1.0 : -1.0) * kSlope * drop;
    side.corners = {first, second, lowered(end.at(outer), drop), lowered(begin.at(outer), drop)};
    side.color = kGrassSlope;
    side.rank = kSlopeRank;
  } else {
    const double height = std::min(drop, kDeckThickness);
    side.corners = {first, second, lowered(second, height), lowered(first, height)};
    side.color = kConcrete;
  }
  side.two_sided = true;
  surfaces.push_back(side);
}

void addBorder(const map::RoadNetwork& network, const map::Lane& lane, double side,
               std::vector<Surface>& surfaces) {
  const auto sections = crossSections(lane.centerline, 0.0, lane.centerline.length(), kPiece);
  const double border = side * 0.5 * lane.width;
  for (std::size_t i = 1; i < sections.size(); ++i) {
    const Eigen::Vector3d middle = 0.5 * (sections[i - 1].at(border) + sections[i].at(border));
    const Eigen::Vector3d along = sections[i].center - sections[i - 1].center;
    if (borderAt(network, lane, middle, std::atan2(along.y(), along.x())) != Border::kEdge)
      continue;
    const Surroundings around = surroundingsOf(network, middle);
    if (middle.z() - around.ground < kLeastHeight) continue;
    addPiece(sections[i - 1], sections[i], border + side * kBeside, around, surfaces);
  }
}

bool isFlat(const map::RoadNetwork& network) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const map::Lane& lane : network.lanes()) {
    for (const Eigen::Vector3d& point : lane.centerline.points()) {
      low = std::min(low, point.z());
      high = std::max(high, point.z());
    }
  }
  return high - low < kLeastHeight;
}

}  // namespace

std::vector<Surface> roadSides(const map::RoadNetwork& network) {
  std::vector<Surface> surfaces;
  if (isFlat(network)) return surfaces;
  for (const map::Lane& lane : network.lanes()) {
    if (lane.internal || !lane.allows_cars || lane.centerline.length() < kLeastHeight) continue;
    if (lane.right == map::kNoLane) addBorder(network, lane, -1.0, surfaces);
    if (lane.left == map::kNoLane) addBorder(network, lane, 1.0, surfaces);
  }
  return surfaces;
}

}  // namespace cdiff::rendering
