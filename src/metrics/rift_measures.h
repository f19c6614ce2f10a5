// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The figures of a session as RIFT's code computes them, quirks included, from decision ticks (10
/// Hz): 2D-TTC and ACT [s] in bins below 5 s at ego speeds of 3 to 10 m/s; speed [m/s],
/// acceleration [m/s^2] and jerk [m/s^3] from histograms in which sample i of an n-tick life counts
/// n - i times, and Shapiro-Wilk of 3000 values drawn from them; closed-form Wasserstein distance
/// [m/s]; at most one collision per life.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "metrics/cbv_measures.h"
#include "metrics/rift_histogram.h"

namespace cdiff::metrics {

class RiftMeasures {
 public:
  /// `decision_period`: time from one decision to the next [s].
  explicit RiftMeasures(double decision_period = 0.1) : decision_period_(decision_period) {}

  /// One decision tick: the ego's speed [m/s], its smallest riftTimeToCollision and
  /// riftApproachTime [s], and the CBVs.
  void observeEgo(double speed, const std::optional<double>& time_to_collision,
                  const std::optional<double>& approach_time = {});
  void observeCbvs(const std::vector<CbvSighting>& cbvs);
  /// A contact in which this CBV takes part, at any tick.
  void countCollision(const std::string& id) { collided_.insert(id); }

  /// Keys: ttc_2d_s, ttc_2d_variance_s2 (RIFT prints it after "+-"), act_s, act_variance_s2,
  /// speed_shapiro_wilk, acceleration_shapiro_wilk, speed_wasserstein_mps, off_road_rate_percent,
  /// collisions_per_km, uncomfortable_rate_percent, reached_progress_m, and speed, acceleration and
  /// jerk as NAME_mean_UNIT and NAME_std_UNIT (mps, mps2, mps3). n counts values before RIFT
  /// repeats them.
  std::map<std::string, Measure> measures() const;

 private:
  /// A CBV since it became one.
  struct Life {
    RiftHistogram speeds = riftSpeedHistogram();
    RiftHistogram accelerations = riftAccelerationHistogram();
    RiftHistogram jerks = riftJerkHistogram();
    double last_acceleration = 0.0;  ///< RIFT begins a life with 0 [m/s^2]
    Eigen::Vector2d last_position = Eigen::Vector2d::Zero();
    std::size_t decisions = 0;
  };
  void live(Life& life, const traffic::Vehicle& vehicle);
  Measure shapiroWilkMeasure(const RiftHistogram& histogram) const;
  Measure wassersteinMeasure() const;
  void addTimes(std::map<std::string, Measure>& result) const;
  void addMotion(std::map<std::string, Measure>& result) const;

  double decision_period_;
  RiftHistogram times_ = riftTtcHistogram();
  RiftHistogram approach_times_ = riftTtcHistogram();
  RiftHistogram speeds_ = riftSpeedHistogram();
  RiftHistogram accelerations_ = riftAccelerationHistogram();
  RiftHistogram jerks_ = riftJerkHistogram();
  TickShare uncomfortable_;
  std::map<std::string, Life> lives_;  ///< of the CBVs of the last decision tick
  std::set<std::string> driven_;
  std::set<std::string> collided_;
  OffRoadRate off_road_;
  double distance_ = 0.0;
};

}  // namespace cdiff::metrics
