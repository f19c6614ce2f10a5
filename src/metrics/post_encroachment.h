// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Post-encroachment time [s] of the ego and each CBV: the time between the first one's box leaving
/// and the second one's box entering a place, the shortest over all places that both boxes sweep.
/// Exact for boxes that keep velocity and heading within a tick.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "metrics/session_measures.h"

namespace cdiff::metrics {

/// A box on its way from one tick to the next, map frame.
struct SweptBox {
  geometry::OrientedBox box;                         ///< where it begins
  Eigen::Vector2d offset = Eigen::Vector2d::Zero();  ///< to where it ends [m]
  double elevation = 0.0;                            ///< [m]
  double begin = 0.0;                                ///< [s]
  double duration = 0.0;                             ///< [s]
};

/// Shortest and longest time from the first box being at a place to the second being there [s],
/// negative when the second was there before; nullopt when they share no place.
struct TimeRange {
  double shortest = 0.0;
  double longest = 0.0;
};
std::optional<TimeRange> timesBetween(const SweptBox& first, const SweptBox& second);

class PostEncroachmentTimes {
 public:
  /// A longer time counts as never sharing a place [s].
  explicit PostEncroachmentTimes(double limit) : limit_(limit) {}

  /// One tick, in order. A CBV counts while its role is CBV, the ego always; vehicles on different
  /// levels share no place.
  void observe(const traffic::TrafficSnapshot& snapshot);
  /// Of every CBV, by id.
  std::vector<PostEncroachment> times() const;
  /// Over the CBVs that have one.
  DistributionMeasure measure() const;

 private:
  /// A vehicle's way of the last `limit_` seconds.
  struct Track {
    std::deque<SweptBox> ways;
    std::optional<traffic::Vehicle> last;  ///< at the last tick, where it was there
    std::optional<double> seconds;         ///< shortest so far
    bool ego_first = false;
  };
  /// The way since the last tick; nullptr when the vehicle was not there then or is not finite.
  const SweptBox* extend(Track& track, const traffic::Vehicle* vehicle, double time) const;
  void compare(Track& cbv, const SweptBox& ego_way, const SweptBox& cbv_way) const;

  double limit_;
  std::optional<double> last_time_;
  Track ego_;
  std::map<std::string, Track> cbvs_;
};

}  // namespace cdiff::metrics
