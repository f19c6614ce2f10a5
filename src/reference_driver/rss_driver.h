// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "reference_driver/conflict.h"
#include "reference_driver/reference_driver.h"

namespace cdiff::reference_driver {

/// Constants of responsibility-sensitive safety (Shalev-Shwartz et al., arXiv 1708.06374), as
/// CARLA's RSS check has them.
struct RssOptions {
  double response_time = 1.0;         ///< rho [s]
  double other_response_time = 2.0;   ///< of others, across and head-on [s]
  double acceleration = 3.5;          ///< in the response time [m/s^2]
  double least_braking = 4.0;         ///< b_min, that a driver applies [m/s^2]
  double hardest_braking = 8.0;       ///< b_max, of the vehicle ahead [m/s^2]
  double correct_braking = 3.0;       ///< b_corr, of who is in its own lane, head-on [m/s^2]
  double lateral_acceleration = 0.2;  ///< [m/s^2]
  double lateral_braking = 0.8;       ///< [m/s^2]
  double lateral_margin = 0.1;        ///< mu [m]
};

/// Safe distance to a vehicle ahead [m], at least 0:
/// v_r rho + a rho^2 / 2 + (v_r + a rho)^2 / 2 b_min - v_f^2 / 2 b_max.
double rssFollowingDistance(const RssOptions& options, double rear_speed, double front_speed);

/// Safe distance head-on [m]: the stopping paths of both; the driver, in its own lane, brakes with
/// b_corr, the other with b_min.
double rssOncomingDistance(const RssOptions& options, double speed, double other_speed);

/// Safe distance beside each other [m]: mu and, for both, (2 v + a rho) rho / 2 +
/// (v + a rho)^2 / 2 b; `approach` is the other's speed toward the driver, who keeps its offset.
double rssLateralDistance(const RssOptions& options, double approach);

/// Driver R: with no safe distance along and none across it brakes with b_min, rho after it was
/// lost. A crossing or merging vehicle is safe where it can still stop before the corridor with
/// b_min, where the following distance holds, or where one is out before the other comes.
class RssDriver final : public ReferenceDriver {
 public:
  explicit RssDriver(const RssOptions& options = {}) : options_(options) {}

  double brake(const OwnMotion& own, const std::vector<SeenVehicle>& seen,
               double duration) override;
  std::unique_ptr<ReferenceDriver> clone() const override;
  /// Whether the distance to a vehicle is not safe.
  bool isUnsafe(const OwnMotion& own, const SeenVehicle& other) const;

 private:
  RssOptions options_;
  double unsafe_since_ = -1.0;  ///< [s]; negative: it is safe
};

}  // namespace cdiff::reference_driver
