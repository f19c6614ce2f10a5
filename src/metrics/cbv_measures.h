// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What is counted of the CBVs, all together: time off the drivable area, collisions, distance [m],
/// speeds [m/s] and signed accelerations [m/s^2] at decision ticks. A vehicle counts at the ticks
/// at which its role is CBV.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "metrics/off_road_rate.h"
#include "metrics/sample_statistics.h"

namespace cdiff::metrics {

/// A CBV of a tick.
struct CbvSighting {
  const traffic::Vehicle* vehicle = nullptr;
  bool off_road = false;
  std::optional<double> wanted_speed = {};  ///< target speed capped by the lane's limit [m/s]
  std::optional<double> ego_distance = {};  ///< of the centres of ego and CBV [m]
  bool corner_off_road = false;             ///< whether any corner of its box is off the road
};

class CbvMeasures {
 public:
  /// One tick: all its CBVs. A CBV that is not among them is no longer one.
  void observe(const std::vector<CbvSighting>& cbvs, bool decision_tick);
  /// One contact between CBVs and anyone: a pair counts once, also when both are CBVs.
  void countCollision(bool with_ego);
  /// Whether a vehicle was a CBV at the last tick observed.
  bool isDriven(const std::string& id) const { return last_positions_.count(id) != 0; }

  std::size_t count() const { return driven_.size(); }
  std::size_t decisions() const { return decisions_; }
  std::size_t collisions() const { return collisions_; }
  std::size_t egoCollisions() const { return ego_collisions_; }
  /// Sum of the chords between ticks at which a vehicle was CBV [m].
  double distance() const { return distance_; }
  const std::vector<double>& speeds() const { return speeds_; }
  const std::vector<double>& accelerations() const { return accelerations_; }
  Measure offRoadRatePercent() const;
  Measure cornerOffRoadRatePercent() const;
  Measure collisionsPerKilometre() const;
  Measure egoCollisionsPerKilometre() const;
  /// Mean of |v - wanted speed| over decisions [m/s].
  Measure speedError() const;
  /// Mean over CBVs of each one's smallest distance to the ego [m].
  Measure closestDistance() const;
  /// The smallest of all distances to the ego [m].
  Measure minimumDistance() const;

 private:
  DistributionMeasure closestDistances() const;

  std::set<std::string> driven_;
  std::map<std::string, Eigen::Vector2d> last_positions_;  ///< of the CBVs of the last tick
  OffRoadRate off_road_;
  OffRoadRate corner_off_road_;
  std::size_t decisions_ = 0;
  std::size_t collisions_ = 0;
  std::size_t ego_collisions_ = 0;
  double distance_ = 0.0;
  std::vector<double> speeds_;
  std::vector<double> accelerations_;
  SampleStatistics speed_errors_;
  std::map<std::string, double> closest_;  ///< smallest distance to the ego, by vehicle [m]
};

/// Reason of every CBV figure of a session without CBVs.
inline constexpr const char* kNoCbv = "no CBV was driven";

}  // namespace cdiff::metrics
