// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/camera_ego/road_lines.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "rendering/lane_surface.h"

namespace cdiff::planners {
namespace {

using Line = std::vector<Eigen::Vector2d>;

constexpr double kLeastLength = 3.0;  // of a piece [m]
constexpr double kFocus = 5.0;        // ahead of the ego, from where nearness is counted [m]
constexpr double kLaneReach = 3.0;    // around the ego, in which lanes are its own [m]

double lengthOf(const Line& line) {
  double length = 0.0;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) length += (line[i + 1] - line[i]).norm();
  return length;
}

/// The part of the segment from a to b within the BEV (Liang and Barsky 1984): shares of its begin
/// and end; begin > end where there is none.
std::pair<double, double> clipped(const BevGrid& bev, const Eigen::Vector2d& a,
                                  const Eigen::Vector2d& b) {
  const Eigen::Vector2d low = bev.origin(), high = bev.fromShare({1.0, 1.0});
  double begin = 0.0, end = 1.0;
  for (int axis = 0; axis < 2; ++axis) {
    const double way = b[axis] - a[axis];
    if (std::abs(way) < 1e-12) {
      if (a[axis] < low[axis] || a[axis] > high[axis]) return {1.0, 0.0};
      continue;
    }
    const double first = (low[axis] - a[axis]) / way, second = (high[axis] - a[axis]) / way;
    begin = std::max(begin, std::min(first, second));
    end = std::min(end, std::max(first, second));
  }
  return {begin, end};
}

/// The pieces of a line (body frame) within the BEV.
std::vector<Line> piecesIn(const BevGrid& bev, const Line& line) {
  std::vector<Line> pieces;
  bool open = false;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const auto [begin, end] = clipped(bev, line[i], line[i + 1]);
    if (begin > end) {
      open = false;
      continue;
    }
    const Eigen::Vector2d way = line[i + 1] - line[i];
    if (!open || begin > 0.0) pieces.push_back({line[i] + begin * way});
    pieces.back().push_back(line[i] + end * way);
    open = end >= 1.0;
  }
  return pieces;
}

std::array<Eigen::Vector2d, kLinePoints> evenly(const Line& line) {
  std::array<Eigen::Vector2d, kLinePoints> points;
  const double spacing = lengthOf(line) / static_cast<double>(kLinePoints - 1);
  double behind = 0.0;
  std::size_t segment = 0;
  for (std::size_t i = 0; i < kLinePoints; ++i) {
    const double wanted = spacing * static_cast<double>(i);
    double length = (line[segment + 1] - line[segment]).norm();
    while (segment + 2 < line.size() && behind + length < wanted) {
      behind += length;
      ++segment;
      length = (line[segment + 1] - line[segment]).norm();
    }
    const double share = length > 0.0 ? std::clamp((wanted - behind) / length, 0.0, 1.0) : 0.0;
    points[i] = line[segment] + share * (line[segment + 1] - line[segment]);
  }
  return points;
}

double distanceFrom(const Line& line, const Eigen::Vector2d& place) {
  double nearest = 1e9;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Eigen::Vector2d way = line[i + 1] - line[i];
    const double square = std::max(1e-12, way.squaredNorm());
    const double share = std::clamp((place - line[i]).dot(way) / square, 0.0, 1.0);
    nearest = std::min(nearest, (line[i] + share * way - place).norm());
  }
  return nearest;
}

bool reachesAhead(const Line& line) {
  return std::any_of(line.begin(), line.end(), [](const auto& point) { return point.x() > 0.0; });
}

}  // namespace

const char* toText(MapKind kind) {
  constexpr const char* kNames[] = {"edge", "divider", "center"};
  return kNames[static_cast<std::size_t>(kind)];
}

RoadLines::RoadLines(const map::RoadNetwork& network, const map::DrivableArea& area)
    : network_(network), area_(area) {
  for (std::size_t i = 0; i < network.lanes().size(); ++i) addLane(static_cast<int>(i));
}

void RoadLines::add(MapKind kind, map::LaneIndex lane, const std::vector<Eigen::Vector3d>& points) {
  if (points.size() < 2) return;
  RoadLine line{kind, lane, points, {}, 0.0};
  for (const Eigen::Vector3d& point : points)
    line.middle += point.head<2>() / static_cast<double>(points.size());
  for (const Eigen::Vector3d& point : points)
    line.radius = std::max(line.radius, (point.head<2>() - line.middle).norm());
  lines_.push_back(std::move(line));
}

void RoadLines::addLane(map::LaneIndex index) {
  const map::Lane& lane = network_.lane(index);
  if (!lane.routable) return;
  add(MapKind::kCenter, lane.internal ? index : map::kNoLane, lane.centerline.points());
  if (lane.internal) return;
  std::vector<Eigen::Vector3d> left;
  for (const rendering::CrossSection& section : rendering::crossSections(
           lane.centerline, 0.0, lane.centerline.length(), lane.centerline.length()))
    left.push_back(section.at(0.5 * lane.width));
  const double middle = 0.5 * lane.centerline.length();
  const double heading = lane.centerline.headingAt(middle);
  Eigen::Vector3d beside = lane.centerline.pointAt(middle);
  beside.head<2>() += 0.5 * lane.width * geometry::leftNormal(geometry::direction(heading));
  const bool to_other_direction =
      lane.left == map::kNoLane &&
      rendering::borderAt(network_, lane, beside, heading) == rendering::Border::kCenter;
  // The lanes of both directions draw the line between them; one is enough.
  if (lane.left != map::kNoLane || (to_other_direction && std::cos(heading - 0.1) >= 0.0))
    add(MapKind::kDivider, map::kNoLane, left);
}

const std::vector<RoadLines::RoadLine>& RoadLines::edgesAt(double elevation) const {
  const long level = std::lround(elevation / traffic::kLevelHeight);
  const auto known = edges_.find(level);
  if (known != edges_.end()) return known->second;
  std::vector<RoadLine>& edges = edges_[level];
  for (std::vector<Eigen::Vector2d> ring : area_.border(elevation)) {
    if (ring.size() < 3) continue;
    ring.push_back(ring.front());
    RoadLine edge;
    for (const Eigen::Vector2d& point : ring) {
      edge.points.emplace_back(point.x(), point.y(), elevation);
      edge.middle += point / static_cast<double>(ring.size());
    }
    for (const Eigen::Vector2d& point : ring)
      edge.radius = std::max(edge.radius, (point - edge.middle).norm());
    edges.push_back(std::move(edge));
  }
  return edges;
}

/// The lanes inside junctions that the ego is on, or that its lanes lead to.
std::vector<map::LaneIndex> RoadLines::lanesAhead(const BevPose& from) const {
  constexpr double kAlong = core::kPi / 3.0;  // [rad]
  std::vector<map::LaneIndex> lanes;
  for (const map::LaneMatch& match :
       network_.lanesNear(from.pose.position, from.elevation, kLaneReach, from.pose.heading)) {
    if (std::abs(match.heading_difference) < kAlong) lanes.push_back(match.lane);
  }
  for (std::size_t i = 0; i < lanes.size() && lanes.size() < 64; ++i) {
    for (const map::LaneLink& link : network_.lane(lanes[i]).next) {
      if (link.to != map::kNoLane && network_.lane(link.to).internal &&
          std::find(lanes.begin(), lanes.end(), link.to) == lanes.end())
        lanes.push_back(link.to);
    }
  }
  return lanes;
}

std::vector<BevLine> RoadLines::around(const BevPose& from, const BevGrid& bev,
                                       std::size_t most) const {
  const double reach = bev.length() + bev.width();
  const std::vector<map::LaneIndex> ahead = lanesAhead(from);
  std::vector<std::pair<double, BevLine>> found;
  const auto look = [&](const RoadLine& line) {
    if ((line.middle - from.pose.position).norm() > line.radius + reach) return;
    if (line.lane != map::kNoLane && std::count(ahead.begin(), ahead.end(), line.lane) == 0) return;
    Line seen;
    for (const Eigen::Vector3d& point : line.points) {
      if (traffic::onDifferentLevels(point.z(), from.elevation)) continue;
      seen.push_back(from.pose.toBody(point.head<2>()));
    }
    for (const Line& piece : piecesIn(bev, seen)) {
      if (lengthOf(piece) < kLeastLength || !reachesAhead(piece)) continue;
      found.push_back({distanceFrom(piece, {kFocus, 0.0}), {line.kind, evenly(piece)}});
    }
  };
  for (const RoadLine& line : lines_) look(line);
  for (const RoadLine& line : edgesAt(from.elevation)) look(line);
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& left, const auto& right) { return left.first < right.first; });
  std::vector<BevLine> lines;
  for (std::size_t i = 0; i < std::min(most, found.size()); ++i) lines.push_back(found[i].second);
  return lines;
}

}  // namespace cdiff::planners
