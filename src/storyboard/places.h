// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "map/lane_graph.h"
#include "map/opendrive_roads.h"
#include "storyboard/scenario.h"

namespace cdiff::storyboard {

/// A place of a reference point in the map frame [m, rad].
struct MapPose {
  geometry::Pose2d pose;
  double elevation = 0.0;  ///< [m]
};

/// The road network of a scenario: finds what positions mean in the map frame.
class Places {
 public:
  using PoseOf = std::function<MapPose(const std::string& entity)>;

  /// `graph` must outlive the object. `roads`: of the OpenDRIVE file; nullopt for a network that
  /// is none, where lane and road positions are refused.
  Places(const map::LaneGraph& graph, std::optional<map::OpenDriveRoads> roads)
      : graph_(graph), roads_(std::move(roads)) {}

  /// The place that a position means; `pose_of` has the places of entities. Without a heading of
  /// its own a position on a lane has that of the lane. Throws InputError with file and line for a
  /// road, a lane or a place that is not there.
  MapPose resolve(const Position& position, const PoseOf& pose_of) const;
  /// Where a lane change leads to, abreast of `self`: `offset` [m] to the left of the road from the
  /// middle of the lane. Throws InputError for a lane that is not there, without a place in the
  /// file.
  Eigen::Vector2d laneTarget(const LaneChangeAction& change, const MapPose& self,
                             const MapPose& reference, double offset) const;
  /// The route along lanes from a place on, straight on where it can; nullopt off every lane of
  /// about that heading.
  std::optional<map::Route> routeFrom(const MapPose& place) const;
  /// The route and what follows, straight on where it can; the same where the network ends.
  map::Route prolonged(const map::Route& route) const;
  /// The route from a place through points in the map frame. Throws InputError.
  map::Route routeThrough(const MapPose& place, std::vector<Eigen::Vector3d> points) const;
  /// Whether a place is on a lane for cars, and whether it is where such a lane ends for good.
  bool isOnLane(const MapPose& place) const;
  bool isEndOfRoad(const MapPose& place) const;
  /// Heading of the nearest lane, or that of the place off every lane.
  double laneHeading(const MapPose& place) const;

 private:
  const map::OpenDriveRoads& roads(const std::string& what) const;
  MapPose onRoad(const std::string& road, double s, double t) const;
  MapPose lanePose(const std::string& road, int lane, double s, double offset) const;
  MapPose onRoute(const Position& position, const PoseOf& pose_of) const;
  bool leadsPast(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                 const Eigen::Vector2d& place) const;
  static MapPose relativeToEntity(const Position& position, MapPose place);
  MapPose withoutOwnHeading(const Position& position, const PoseOf& pose_of) const;
  MapPose relativeToLane(const Position& position, const MapPose& reference) const;
  MapPose relativeToRoad(const Position& position, const MapPose& reference) const;
  map::RoadPlace roadPlace(const MapPose& place) const;
  std::optional<map::LanePosition> laneAt(const MapPose& place) const;

  const map::LaneGraph& graph_;
  std::optional<map::OpenDriveRoads> roads_;
};

}  // namespace cdiff::storyboard
