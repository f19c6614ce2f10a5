// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The figures of a session as RIFT's code computes them, quirks included, from decision ticks (10
/// Hz): 2D-TTC [s] from ray casts in bins below 5 s at ego speeds of 3 to 10 m/s; Shapiro-Wilk of
/// 3000 values drawn from histograms in which sample i of an n-tick life counts n - i times;
/// closed-form Wasserstein distance [m/s]; at most one collision per life.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "e2e_cdiff/metrics/cbv_measures.h"
#include "e2e_cdiff/metrics/rift_histogram.h"

namespace cdiff::metrics {

class RiftMeasures {
 public:
  /// One decision tick: the ego's speed, its smallest riftTimeToCollision, and the CBVs.
  void observeEgo(double speed, const std::optional<double>& time_to_collision);
  void observeCbvs(const std::vector<CbvSighting>& cbvs);
  /// A contact in which this CBV takes part, at any tick.
  void countCollision(const std::string& id) { collided_.insert(id); }

  /// Keys: ttc_2d_s, ttc_2d_variance_s2 (RIFT prints it after "+-"), speed_shapiro_wilk,
  /// acceleration_shapiro_wilk, speed_wasserstein_mps, off_road_rate_percent, collisions_per_km. n
  /// counts values before RIFT repeats them.
  std::map<std::string, Measure> measures() const;

 private:
  /// A CBV since it became one.
  struct Life {
    RiftHistogram speeds = riftSpeedHistogram();
    RiftHistogram accelerations = riftAccelerationHistogram();
    Eigen::Vector2d last_position = Eigen::Vector2d::Zero();
    std::size_t decisions = 0;
  };
  void live(Life& life, const traffic::Vehicle& vehicle);
  Measure shapiroWilkMeasure(const RiftHistogram& histogram) const;
  Measure wassersteinMeasure() const;

  RiftHistogram times_ = riftTtcHistogram();
  RiftHistogram speeds_ = riftSpeedHistogram();
  RiftHistogram accelerations_ = riftAccelerationHistogram();
  std::map<std::string, Life> lives_;  ///< of the CBVs of the last decision tick
  std::set<std::string> driven_;
  std::set<std::string> collided_;
  OffRoadRate off_road_;
  double distance_ = 0.0;
};

}  // namespace cdiff::metrics
