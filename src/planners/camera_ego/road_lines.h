// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <map>
#include <vector>

#include "e2e_cdiff/geometry/shapes.h"
#include "e2e_cdiff/map/drivable_area.h"
#include "e2e_cdiff/map/road_network.h"
#include "planners/camera_ego/bev_grid.h"

namespace cdiff::planners {

/// What a line of the map is: the border of the drivable area; the marking between two lanes; the
/// centerline of a lane, in its direction.
enum class MapKind { kEdge = 0, kDivider = 1, kCenter = 2 };
/// "edge", "divider" or "center".
const char* toText(MapKind kind);
/// Whether a line of this kind reads the same from either end.
inline bool hasNoDirection(MapKind kind) { return kind != MapKind::kCenter; }

/// Points of every line of the map, evenly along it.
inline constexpr std::size_t kLinePoints = 10;

/// A piece of a line within a BEV (body frame [m]).
struct BevLine {
  MapKind kind = MapKind::kEdge;
  std::array<Eigen::Vector2d, kLinePoints> points{};
};

/// A place to look from.
struct BevPose {
  geometry::Pose2d pose;   ///< map frame
  double elevation = 0.0;  ///< [m]
};

/// The lines of a road network: edges, dividers and centerlines. Centerlines in junctions are those
/// that the lanes around the ego lead to.
class RoadLines {
 public:
  /// Both must outlive it.
  RoadLines(const map::RoadNetwork& network, const map::DrivableArea& area);
  /// The pieces within the BEV of at least 3 m that reach ahead of the ego, at most `most`: those
  /// that pass nearest to 5 m ahead of it, nearest first.
  std::vector<BevLine> around(const BevPose& from, const BevGrid& bev, std::size_t most) const;

 private:
  /// A line with the circle around it.
  struct RoadLine {
    MapKind kind = MapKind::kEdge;
    map::LaneIndex lane = map::kNoLane;  ///< of a centerline in a junction
    std::vector<Eigen::Vector3d> points;
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    double radius = 0.0;
  };
  void add(MapKind kind, map::LaneIndex lane, const std::vector<Eigen::Vector3d>& points);
  void addLane(map::LaneIndex index);
  const std::vector<RoadLine>& edgesAt(double elevation) const;
  std::vector<map::LaneIndex> lanesAhead(const BevPose& from) const;

  const map::RoadNetwork& network_;
  const map::DrivableArea& area_;
  std::vector<RoadLine> lines_;
  mutable std::map<long, std::vector<RoadLine>> edges_;  ///< by level
};

}  // namespace cdiff::planners
