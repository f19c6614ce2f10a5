// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <unordered_map>
#include <vector>

#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::planners {

/// A vehicle at a decision (map frame, SI units), small enough to keep whole sessions of them.
struct TrackPoint {
  std::uint32_t vehicle = 0;  ///< number in a VehicleTable
  float acceleration = 0.0F;  ///< [m/s^2]
  float steer = 0.0F;         ///< last applied; 0 where SUMO drives
  float brake = 0.0F;         ///< likewise
  traffic::VehicleState state;
};

/// All vehicles at a decision, ascending by their numbers.
struct TrackFrame {
  double time = 0.0;  ///< [s]
  std::vector<TrackPoint> points;

  /// nullptr where the vehicle is not there.
  const TrackPoint* find(std::uint32_t vehicle) const;
};

/// Vehicles by number, in the order of their first appearance.
class VehicleTable {
 public:
  /// Adds it where it is unknown.
  std::uint32_t numberOf(const traffic::Vehicle& vehicle);
  const std::string& id(std::uint32_t vehicle) const { return ids_.at(vehicle); }
  const traffic::VehicleDimensions& size(std::uint32_t vehicle) const { return sizes_.at(vehicle); }
  std::size_t count() const { return ids_.size(); }

 private:
  std::unordered_map<std::string, std::uint32_t> numbers_;
  std::vector<std::string> ids_;
  std::vector<traffic::VehicleDimensions> sizes_;
};

TrackFrame frameOf(const traffic::TrafficSnapshot& snapshot, VehicleTable& vehicles);

/// The last decisions that a planner was asked at, at most two seconds of them: fewer at the start
/// of a session and after a decision at which it was not asked.
class RecentTracks {
 public:
  /// `period`: from one decision to the next [s].
  explicit RecentTracks(double period) : period_(period) {}
  void add(const traffic::TrafficSnapshot& snapshot);
  /// Oldest first; the last is that of the last call.
  std::vector<const TrackFrame*> frames() const;
  VehicleTable& vehicles() { return vehicles_; }

 private:
  double period_;
  VehicleTable vehicles_;
  std::deque<TrackFrame> frames_;
};

}  // namespace cdiff::planners
