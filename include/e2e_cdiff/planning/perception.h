// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "e2e_cdiff/geometry/shapes.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::planning {

// What a planner attended to, weighed and believed to see when it decided, for people who look:
// markers, report, video. Nothing drives by it.

/// How much a planner looked at a vehicle when it decided.
struct AttendedVehicle {
  std::string vehicle_id;  ///< in the snapshot
  double weight = 0.0;     ///< share of the planner's attention, in [0, 1]; all together at most 1
};

/// Time from one place of a candidate to the next [s].
inline constexpr double kCandidateStep = 0.5;

/// A plan that a planner weighed against others (map frame).
struct PlannedCandidate {
  std::vector<Eigen::Vector2d> places;  ///< kCandidateStep apart, the first one that far ahead [m]
  double score = 0.0;                   ///< in the planner's own measure; the larger the better
  bool chosen = false;                  ///< the rollout comes from it
};

/// A way that a planner thinks another vehicle may take (map frame).
struct PerceivedForecast {
  std::vector<Eigen::Vector2d> places;  ///< kCandidateStep apart, the first one that far ahead [m]
  double probability = 0.0;             ///< in [0, 1]
};

/// A vehicle that a planner believes to see (map frame).
struct PerceivedVehicle {
  traffic::VehicleState state;               ///< as it is believed to be
  traffic::VehicleDimensions dimensions;     ///< likewise
  double score = 0.0;                        ///< in [0, 1]
  std::vector<PerceivedForecast> forecasts;  ///< in the planner's own order
};

/// A line of the road that a planner believes to see (map frame).
struct PerceivedLine {
  std::string kind;                     ///< "edge", "divider" or "center"
  std::vector<Eigen::Vector2d> points;  ///< [m]
  double score = 0.0;                   ///< in [0, 1]
};

/// Which cells around the vehicle a planner expects to be occupied, at one time ahead: row-major,
/// rows along the vehicle's x, columns along its y; the first cell's corner lies at `origin`.
struct PerceivedOccupancy {
  double time = 0.0;                                 ///< ahead [s]
  geometry::Pose2d frame;                            ///< of the vehicle now (map frame)
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< in `frame` [m]
  double cell = 1.0;                                 ///< side of a cell [m]
  int rows = 0;                                      ///< number of cells along x
  int columns = 0;                                   ///< number of cells along y
  std::vector<float> probability;                    ///< [rows x columns], in [0, 1]
};

/// What a planner believes to see when it decides.
struct Perception {
  std::vector<PerceivedVehicle> vehicles;     ///< in the planner's own order
  std::vector<PerceivedLine> lines;           ///< likewise
  std::vector<PerceivedOccupancy> occupancy;  ///< by time
  /// Whether it holds nothing.
  bool empty() const { return vehicles.empty() && lines.empty() && occupancy.empty(); }
};

/// The forecast of the largest probability, the first of equals; there must be one.
const PerceivedForecast& likeliest(const std::vector<PerceivedForecast>& forecasts);

/// Centers of the cells that are occupied with a probability above 0.5, in `occupancy.frame` [m].
std::vector<Eigen::Vector2d> occupiedCells(const PerceivedOccupancy& occupancy);

}  // namespace cdiff::planning
