// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/map/road_network.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "rendering/road_scene.h"

namespace cdiff::rendering {

/// The beams of a sensor that measures distances all around a vehicle: `rings` cones, evenly spaced
/// from `lowest` to `highest` [rad] above the horizon, of `beams` each. It stands upright above the
/// center of the vehicle's box.
struct RangeSensorOptions {
  std::int64_t rings = 1;
  std::int64_t beams = 720;  ///< of a ring, counter-clockwise; the first one looks backward
  double lowest = 0.0;       ///< [rad]
  double highest = 0.0;      ///< [rad]
  double height = 0.6;       ///< above the road [m]
  double range = 50.0;       ///< farther things are not seen [m]

  /// One horizontal ring at bumper height, 720 beams: a 2D laser scanner.
  static RangeSensorOptions laser() { return {}; }
  /// 16 rings from 15 degrees below to 5 degrees above the horizon on the roof, 360 beams each.
  static RangeSensorOptions lidar() { return {16, 360, -0.261799, 0.087266, 1.9, 60.0}; }

  void describe(core::OptionsVisitor& visitor);
  /// Throws InputError with `group` before the keys ("ego.lidar.") unless lowest <= highest, both
  /// equal where there is one ring, and there are at most 200,000 beams in all.
  void validate(const std::string& group) const;
  /// Angle of a ring above the horizon [rad]; ring 0 is the lowest.
  double elevation(std::int64_t ring) const;
  /// Angle of a beam from the vehicle's heading [rad], in [-pi, pi).
  double azimuth(std::int64_t beam) const;
};

/// What a range sensor measured at one tick.
struct RangeScan {
  std::uint64_t tick = 0;
  std::vector<float> ranges;  ///< [m] by ring, then beam; infinity where nothing is in range
};

/// Casts beams into the scene: boxes of the other vehicles, roads, slopes and bridges (map frame
/// [m]). Exact and without noise; the same input gives the same bytes. Beyond the roads there is
/// nothing to hit. One per thread.
class RangeSensor {
 public:
  /// Throws InputError as RangeSensorOptions::validate does.
  RangeSensor(const RangeSensorOptions& options, const map::RoadNetwork& network,
              const std::string& group = "");

  /// From the vehicle with this id, which it does not see itself. Throws InputError when the
  /// snapshot does not hold it (it was removed).
  RangeScan scan(const traffic::TrafficSnapshot& snapshot, const std::string& vehicle_id);
  /// The points that beams hit, in the frame base_link of the vehicle (x forward, y left, z up from
  /// the road [m]), by ring, then beam.
  std::vector<Eigen::Vector3f> points(const RangeScan& scan) const;
  const RangeSensorOptions& options() const { return options_; }

 private:
  struct Beams;
  void castAtSurface(const Surface& surface, const Eigen::Vector3d& origin, double heading,
                     std::vector<float>& ranges) const;
  void castAtVehicle(const traffic::Vehicle& vehicle, const Eigen::Vector3d& origin, double heading,
                     std::vector<float>& ranges) const;
  Beams beamsToward(const Eigen::Vector3d* corners, int count) const;

  RangeSensorOptions options_;
  std::vector<Surface> surfaces_;
  std::vector<Bound> bounds_;
  std::vector<Eigen::Vector3d> directions_;  ///< unit vectors in base_link, by ring, then beam
};

}  // namespace cdiff::rendering
