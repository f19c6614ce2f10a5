// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::planners {

/// Sizes of PlanT's network and of what it is given; they travel in the metadata of the weight
/// file.
struct PlantArchitecture {
  std::int64_t layers = 4;       ///< of the transformer's encoder
  std::int64_t width = 256;      ///< of a token, a multiple of 16 x heads
  std::int64_t heads = 8;        ///< of attention
  std::int64_t hidden = 1024;    ///< of the feed-forward networks, a multiple of 16
  std::int64_t vehicles = 24;    ///< most vehicle tokens; the nearest are kept
  double radius = 50.0;          ///< vehicles farther away get no token [m]
  double light_distance = 30.0;  ///< a light counts up to this far before its stop line [m]
  bool own_vehicle = false;      ///< the driven vehicle is the first vehicle token, with its speed
                                 ///< (`input_ego` of PlanT's code, off there, too)

  void describe(core::OptionsVisitor& visitor);
  /// Throws InputError for sizes that do not fit each other.
  void validate() const;
};

inline constexpr std::int64_t kPlantAttributes = 6;
inline constexpr std::int64_t kPlantWaypoints = 4;
inline constexpr double kPlantWaypointPeriod = 0.5;  ///< from one waypoint to the next [s]

// Scales of the attributes: what an input of 1 stands for.
inline constexpr double kPlantPlaceScale = 50.0;        ///< x and y [m]
inline constexpr double kPlantSpeedScale = 20.0;        ///< [m/s]
inline constexpr double kPlantExtentScale = 10.0;       ///< width and length [m]
inline constexpr std::size_t kPlantSpeedAttribute = 3;  ///< place of the speed in a token

/// Attributes of a box in the frame of the driven vehicle: x / 50 m, y / 50 m, heading / pi, speed
/// / 20 m/s (of a route segment: its number, 0 or 1), width / 10 m, length / 10 m (PlanT, Renz et
/// al. 2022, section 3; its own are neither scaled nor in radians).
using PlantToken = std::array<float, kPlantAttributes>;

PlantToken plantToken(const geometry::Pose2d& frame, const traffic::VehicleState& state,
                      const traffic::VehicleDimensions& size);

/// What PlanT is given of a moment.
struct PlantInput {
  std::vector<PlantToken> vehicles;  ///< within the radius on the vehicle's level, nearest first;
                                     ///< with `own_vehicle` itself among them
  std::vector<std::string> ids;      ///< of these
  std::vector<PlantToken> route;     ///< at most two segments of the route ahead, nearest first
  bool red_light = false;            ///< a light ahead on the route is not green
  std::array<float, 2> target{};     ///< target point / 50 m, in the vehicle's frame
};

/// `arc_length`: the vehicle's place on its route [m], as planning::RouteFollower gives it. Every
/// state in the snapshot must be finite.
PlantInput plantInput(const PlantArchitecture& architecture,
                      const traffic::TrafficSnapshot& snapshot, const traffic::Vehicle& vehicle,
                      const map::Route& route, double arc_length);

/// Segments of the route ahead as boxes: its points every 3.5 m (50 at most), simplified to 0.5 m;
/// of the segments that begin within 30 m the first two, those longer than 10 m parted evenly; of
/// the parts the first two. None behind the route's end.
std::vector<PlantToken> plantRoute(const geometry::Pose2d& pose, double width,
                                   const map::Route& route, double arc_length);

/// The next node of the sparse route that is more than 7.5 m ahead, in the map frame: nodes lie
/// every 50 m, where junctions begin and end, and at the route's end, which is given beyond it.
Eigen::Vector2d plantTargetPoint(const map::Route& route, double arc_length);

}  // namespace cdiff::planners
