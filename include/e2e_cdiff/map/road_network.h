// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "e2e_cdiff/geometry/shapes.h"

namespace cdiff::map {

/// Index of a lane in RoadNetwork::lanes(); -1 means none.
using LaneIndex = int;
constexpr LaneIndex kNoLane = -1;

/// A lane-to-lane connection. Internal (via) lanes are lanes of their own: `from -> via -> ... ->
/// to`.
struct LaneLink {
  LaneIndex to = kNoLane;  ///< the next lane driven on (the internal lane where there is one)
  std::string signal_id;   ///< traffic light that controls the link; empty when none
  int signal_link = -1;    ///< its position in the light's state text
  char direction = 's';    ///< SUMO's letter: s l r L R t
  char state = '-';  ///< SUMO's right of way: M m = s (stop) w (all-way stop) o O Z; - unknown

  /// Whether every vehicle must stop before it drives on here.
  bool hasStopSign() const { return state == 's' || state == 'w'; }
};

/// One lane of the network: centerline (x, y, z) in the map frame [m], width [m], limit [m/s],
/// neighbors and links by index.
struct Lane {
  std::string id;                 ///< SUMO's id, e.g. "edge_0" or ":junction_3_0"
  std::string edge_id;            ///< e.g. "edge"
  int index = 0;                  ///< in its edge, 0 = rightmost
  geometry::Polyline centerline;  ///< map frame [m]
  double width = 3.2;             ///< [m]
  double speed_limit = 13.89;     ///< [m/s]
  bool internal = false;          ///< lies inside a junction
  bool allows_cars = true;        ///< a passenger car may use it (counts as drivable area)
  bool routable =
      true;  ///< allows cars and its limit is at least 2 m/s: routes and demand may use it
  LaneIndex left = kNoLane;         ///< neighbor of the same edge
  LaneIndex right = kNoLane;        ///< neighbor of the same edge
  std::vector<LaneLink> next;       ///< lanes that follow, by index
  std::vector<LaneIndex> previous;  ///< lanes that lead here, by index
  std::string junction_id;          ///< junction it lies in (internal) or ends at
};

/// A junction of the network: position and outline in the map frame [m].
struct Junction {
  std::string id;    ///< SUMO's id
  std::string type;  ///< SUMO's type: priority, traffic_light, dead_end ...
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< its node
  std::vector<Eigen::Vector3d> shape;                  ///< outline; may be empty
};

/// A lane near a point.
struct LaneMatch {
  LaneIndex lane = kNoLane;         ///< the lane
  geometry::Projection projection;  ///< onto the lane's centerline
  double heading_difference = 0.0;  ///< lane heading minus asked heading, in (-pi, pi] [rad]
};

/// A SUMO road network as geometry and lane graph: lanes with centerlines (x, y, z) in the map
/// frame [m], junctions, connections and traffic lights. The map frame is the network's own plane
/// (netOffset already applied by SUMO).
class RoadNetwork {
 public:
  /// Parses network text as SUMO 1.15 reads it (see importNetwork for newer files). `name` is used
  /// in errors. Throws InputError naming the file, the element and what was expected.
  static RoadNetwork fromText(std::string_view xml, const std::string& name);

  RoadNetwork(RoadNetwork&&) noexcept;             ///< move
  RoadNetwork& operator=(RoadNetwork&&) noexcept;  ///< move
  ~RoadNetwork();

  /// All lanes, by index.
  const std::vector<Lane>& lanes() const { return lanes_; }
  /// A lane of this network; the index is not checked.
  const Lane& lane(LaneIndex index) const { return lanes_[static_cast<std::size_t>(index)]; }
  /// All junctions, in file order.
  const std::vector<Junction>& junctions() const { return junctions_; }
  /// Index of a lane by SUMO's id, or kNoLane.
  LaneIndex findLane(const std::string& id) const;
  /// Lanes of an edge from right to left; empty when there is no such edge.
  std::vector<LaneIndex> lanesOfEdge(const std::string& edge_id) const;
  /// All edge ids in file order, internal ones left out.
  const std::vector<std::string>& edgeIds() const { return edge_ids_; }
  /// netOffset of `<location>` [m]: network position = source position + offset.
  const Eigen::Vector2d& netOffset() const { return net_offset_; }

  /// Lanes that allow cars and whose centerline passes within `radius` of a point in the plane and
  /// within `level_height` of its elevation, nearest first, ties by index. `heading` fills
  /// heading_difference.
  std::vector<LaneMatch> lanesNear(const Eigen::Vector2d& position, double elevation, double radius,
                                   double heading = 0.0, double level_height = 3.0) const;
  /// The same for a point of unknown elevation.
  std::vector<LaneMatch> lanesNear(const Eigen::Vector2d& position, double radius) const;

 private:
  RoadNetwork();
  struct SpatialIndex;
  friend class NetworkReader;
  std::vector<Lane> lanes_;
  std::vector<Junction> junctions_;
  std::vector<std::string> edge_ids_;
  std::unordered_map<std::string, LaneIndex> lane_by_id_;
  Eigen::Vector2d net_offset_ = Eigen::Vector2d::Zero();
  std::unique_ptr<SpatialIndex> index_;
};

}  // namespace cdiff::map
