// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::guidance {

// Where the ways of vehicles meet, and who of two goes first there (map frame, SI units).

/// Added to a box at each end and each side [m].
struct Gaps {
  double longitudinal = 0.0;
  double lateral = 0.0;
};

/// The outline of a vehicle, with gaps around it.
geometry::OrientedBox boxOf(const geometry::Pose2d& pose,
                            const traffic::VehicleDimensions& dimensions, const Gaps& gaps = {});

/// Part of a route [m]; nothing where begin is above end.
struct Stretch {
  double begin = std::numeric_limits<double>::infinity();
  double end = -std::numeric_limits<double>::infinity();

  bool empty() const { return begin > end; }
  void add(double arc_length);
};

/// A vehicle on its route.
struct RoutedVehicle {
  std::string id;
  traffic::VehicleState state;
  traffic::VehicleDimensions dimensions;
  const map::Route* route = nullptr;  ///< never null nor empty
  double arc_length = 0.0;            ///< of the vehicle on its route, also beyond its ends [m]
  double target_speed = 0.0;          ///< [m/s]
};

/// What a vehicle can sweep within a time: its box, with gaps, every 0.5 m along its route from
/// where it is, straight on beyond the ends of that, at its present lateral offset.
class RouteStrip {
 public:
  RouteStrip(const RoutedVehicle& vehicle, const Gaps& gaps, double time);

  /// Where the vehicle meets another box.
  Stretch meeting(const geometry::OrientedBox& other) const;
  /// Where it meets anything of another strip.
  Stretch meeting(const RouteStrip& other) const;

 private:
  double start_;  ///< arc length of the first box [m]
  std::vector<geometry::OrientedBox> boxes_;
};

/// Who of two vehicles goes first where their strips of 3.2 s at target speed meet, the one
/// question answered once for both: the one whose box is in the other's strip already; where both
/// are, the one ahead along the mean of their directions, and neither where they face each other;
/// else the one that is there first at its present speed, within 0.5 s the one whose name sorts
/// first.
class RightOfWay {
 public:
  RightOfWay() = default;
  explicit RightOfWay(const std::vector<RoutedVehicle>& vehicles);

  /// Whether `first` need not wait for `second`.
  bool mayGo(const std::string& first, const std::string& second) const;

 private:
  std::vector<std::pair<std::string, std::string>> waits_;  ///< the first for the second; sorted
};

}  // namespace cdiff::guidance
