// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "rendering/lane_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rendering/road_scene.h"

namespace cdiff::rendering {
namespace {

constexpr double kLongestMiter = 2.0;  // of the lateral distance
constexpr double kSame = 1e-9;         // [m]

Eigen::Vector2d unitAlong(const geometry::Polyline& line, std::size_t segment) {
  const auto& points = line.points();
  const Eigen::Vector2d along = (points[segment + 1] - points[segment]).head<2>();
  return along / along.norm();
}

/// Left normal at a point of the line; at a bend the bisector, with the length at which both
/// borders meet.
Eigen::Vector2d leftAtPoint(const geometry::Polyline& line, std::size_t index) {
  const std::size_t last = line.points().size() - 1;
  if (index == 0) return geometry::leftNormal(unitAlong(line, 0));
  if (index == last) return geometry::leftNormal(unitAlong(line, last - 1));
  const Eigen::Vector2d before = unitAlong(line, index - 1);
  const Eigen::Vector2d sum = before + unitAlong(line, index);
  const double length = sum.norm();
  if (length < 1e-6) return geometry::leftNormal(before);
  const Eigen::Vector2d middle = sum / length;
  const double cosine = middle.x() * before.x() + middle.y() * before.y();
  return geometry::leftNormal(middle) / std::max(cosine, 1.0 / kLongestMiter);
}

CrossSection between(const geometry::Polyline& line, std::size_t segment, double arc_length) {
  const double begin = line.arcLengths()[segment];
  const double share = (arc_length - begin) / (line.arcLengths()[segment + 1] - begin);
  CrossSection section;
  section.arc_length = arc_length;
  section.center =
      line.points()[segment] + share * (line.points()[segment + 1] - line.points()[segment]);
  section.left = geometry::leftNormal(unitAlong(line, segment));
  return section;
}

CrossSection sectionAt(const geometry::Polyline& line, double arc_length) {
  const auto& arcs = line.arcLengths();
  const auto after = std::upper_bound(arcs.begin(), arcs.end(), arc_length);
  const auto index = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(
      after - arcs.begin() - 1, 0, static_cast<std::ptrdiff_t>(arcs.size()) - 1));
  if (arc_length - arcs[index] <= kSame || index + 1 == arcs.size()) {
    return {line.points()[index], leftAtPoint(line, index), arcs[index]};
  }
  return between(line, index, arc_length);
}

}  // namespace

std::vector<CrossSection> crossSections(const geometry::Polyline& line, double begin, double end,
                                        double spacing) {
  std::vector<double> stations = {begin};
  const auto add = [&](double arc_length) {
    const double from = stations.back();
    const int pieces = std::max(1, static_cast<int>(std::ceil((arc_length - from) / spacing)));
    for (int i = 1; i < pieces; ++i) stations.push_back(from + (arc_length - from) * i / pieces);
    stations.push_back(arc_length);
  };
  for (const double arc_length : line.arcLengths()) {
    if (arc_length > begin + kSame && arc_length < end - kSame) add(arc_length);
  }
  add(end);
  std::vector<CrossSection> sections;
  for (const double station : stations) sections.push_back(sectionAt(line, station));
  return sections;
}

namespace {

constexpr double kLineWidth = 0.15;    // [m]
constexpr double kInset = 0.12;        // [m] of an edge line's middle from the lane's border
constexpr double kDash = 3.0;          // [m]
constexpr double kDashPeriod = 9.0;    // [m]
constexpr double kPiece = 10.0;        // [m] longest piece of a line
constexpr double kOppositeGap = 0.8;   // [m] between borders of lanes that share a centerline
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

namespace {

constexpr double kSlopePiece = 10.0;    // [m] along the lane
constexpr double kMostHeight = 12.0;    // [m] a slope goes at most this far down
constexpr double kLeastHeight = 0.4;    // [m] lower roads lie on the ground
constexpr double kSlope = 1.5;          // [m] outwards per meter down
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

/// The piece between two cross-sections, at the border `lateral` meters to the left.
Surface slopePiece(const CrossSection& begin, const CrossSection& end, double lateral,
                   double drop) {
  const double outer = lateral + (lateral > 0.0 ? 1.0 : -1.0) * kSlope * drop;
  Surface side;
  side.corners = {begin.at(lateral), end.at(lateral), lowered(end.at(outer), drop),
                  lowered(begin.at(outer), drop)};
  side.color = kGrassSlope;
  side.rank = kSlopeRank;
  side.kind = SceneClass::kTerrain;
  side.two_sided = true;
  return side;
}

Surface deckPiece(const CrossSection& begin, const CrossSection& end, double lateral) {
  Surface side;
  side.corners = {begin.at(lateral), end.at(lateral), lowered(end.at(lateral), kDeckThickness),
                  lowered(begin.at(lateral), kDeckThickness)};
  side.color = kConcrete;
  side.kind = SceneClass::kStructure;
  side.two_sided = true;
  return side;
}

void addBorder(const map::RoadNetwork& network, const map::Lane& lane, double side, double ground,
               std::vector<Surface>& surfaces) {
  const auto sections = crossSections(lane.centerline, 0.0, lane.centerline.length(), kSlopePiece);
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

/// Whether a lane rises nowhere as far above the ground as a side needs.
bool liesOnGround(const map::Lane& lane, double ground) {
  const auto& points = lane.centerline.points();
  return std::all_of(points.begin(), points.end(), [&](const Eigen::Vector3d& point) {
    return point.z() - ground < kLeastHeight;
  });
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
    if (liesOnGround(lane, ground)) continue;
    if (lane.right == map::kNoLane) addBorder(network, lane, -1.0, ground, surfaces);
    if (lane.left == map::kNoLane) addBorder(network, lane, 1.0, ground, surfaces);
  }
  return surfaces;
}

}  // namespace cdiff::rendering
