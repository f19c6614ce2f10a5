// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "reference_driver/rss_driver.h"

#include <algorithm>
#include <cmath>

namespace cdiff::reference_driver {
namespace {

constexpr double kLookAhead = 10.0;  // of crossing vehicles [s]

double stoppingPath(double speed, double response, double acceleration, double braking) {
  const double faster = speed + acceleration * response;
  return speed * response + 0.5 * acceleration * response * response +
         faster * faster / (2.0 * braking);
}

}  // namespace

double rssFollowingDistance(const RssOptions& options, double rear_speed, double front_speed) {
  const double own =
      stoppingPath(rear_speed, options.response_time, options.acceleration, options.least_braking);
  return std::max(0.0, own - front_speed * front_speed / (2.0 * options.hardest_braking));
}

double rssOncomingDistance(const RssOptions& options, double speed, double other_speed) {
  return stoppingPath(speed, options.response_time, options.acceleration, options.correct_braking) +
         stoppingPath(other_speed, options.other_response_time, options.acceleration,
                      options.least_braking);
}

double rssLateralDistance(const RssOptions& options, double approach) {
  const double a = options.lateral_acceleration;
  const double b = options.lateral_braking;
  return options.lateral_margin + stoppingPath(0.0, options.response_time, a, b) +
         std::max(0.0, stoppingPath(approach, options.other_response_time, a, b));
}

bool RssDriver::isUnsafe(const OwnMotion& own, const SeenVehicle& other) const {
  const Conflict conflict = conflictOf(own, own.speed, other);
  if (conflict.gap < 0.0) return false;
  const double ahead = std::max(0.0, other.along_speed);
  const bool follows = conflict.gap >= rssFollowingDistance(options_, own.speed, ahead);
  const double approach =
      std::max(0.0, other.offset < own.offset ? other.across_speed : -other.across_speed);
  const bool beside = conflict.to_corridor >= rssLateralDistance(options_, approach);
  switch (conflict.kind) {
    case ConflictKind::kOncoming:
      return !beside && conflict.gap < rssOncomingDistance(options_, own.speed, -other.along_speed);
    case ConflictKind::kLead:
    case ConflictKind::kCutIn:
      return !beside && !follows;
    default:
      return conflict.stops_before > options_.least_braking && !follows &&
             meets(conflict, kLookAhead, 0.0);
  }
}

double RssDriver::brake(const OwnMotion& own, const std::vector<SeenVehicle>& seen, double) {
  const bool unsafe = std::any_of(seen.begin(), seen.end(),
                                  [&](const SeenVehicle& other) { return isUnsafe(own, other); });
  if (!unsafe) unsafe_since_ = -1.0;
  if (unsafe && unsafe_since_ < 0.0) unsafe_since_ = own.time;
  const bool acts = unsafe && own.time - unsafe_since_ >= options_.response_time - kTimeTolerance;
  return acts ? options_.least_braking : 0.0;
}

std::unique_ptr<ReferenceDriver> RssDriver::clone() const {
  return std::make_unique<RssDriver>(*this);
}

}  // namespace cdiff::reference_driver
