// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "cbv/candidate_gates.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cbv/cbv_options.h"
#include "e2e_cdiff/core/angle.h"

namespace cdiff::cbv {
namespace {

constexpr double kSearchRadius = 5.0;       // [m] at least half the width of any lane
constexpr double kHeadingAgreement = 60.0;  // [deg] of a vehicle with its own lane
constexpr double kLeastRemaining = 0.5;     // [m] of its lane: a route may start with a lane change
constexpr double kMetersPerRadian = 2.0;    // among overlapping lanes: heading against distance

bool liesOn(const map::RoadNetwork& network, const map::LaneMatch& match) {
  return match.projection.distance <= 0.5 * network.lane(match.lane).width;
}

/// kOffLane, kJunctionHeading or nullptr for the lanes near the preview point.
const char* failedPreview(const map::RoadNetwork& network, const std::vector<map::LaneMatch>& near,
                          double junction_heading_gate) {
  const char* reason = kOffLane;
  for (const map::LaneMatch& match : near) {
    if (!liesOn(network, match)) continue;
    const double difference = core::radiansToDegrees(std::abs(match.heading_difference));
    if (!network.lane(match.lane).internal || difference <= junction_heading_gate) return nullptr;
    reason = kJunctionHeading;
  }
  return reason;
}

std::optional<map::LanePosition> ownLane(const map::RoadNetwork& network,
                                         const traffic::Vehicle& vehicle) {
  const auto& state = vehicle.state;
  std::optional<map::LanePosition> best;
  double best_cost = std::numeric_limits<double>::infinity();
  for (const map::LaneMatch& match :
       network.lanesNear(state.position, state.elevation, kSearchRadius, state.heading)) {
    const double difference = std::abs(match.heading_difference);
    if (core::radiansToDegrees(difference) >= kHeadingAgreement) continue;
    const map::Lane& lane = network.lane(match.lane);
    const double last = std::max(0.0, lane.centerline.length() - kLeastRemaining);
    const map::LanePosition place{match.lane, std::min(match.projection.arc_length, last)};
    if (lane.id == vehicle.lane_id && liesOn(network, match)) return place;
    const double cost = match.projection.distance + kMetersPerRadian * difference;
    if (cost >= best_cost) continue;
    best_cost = cost;
    best = place;
  }
  return best;
}

}  // namespace

const char* failedNearness(const traffic::Vehicle& vehicle, const traffic::Vehicle& ego,
                           const CbvOptions& options) {
  const double distance = (vehicle.state.position - ego.state.position).norm();
  if (distance > options.search_radius) return kTooFar;
  if (distance < options.minimum_distance) return kTooNear;
  return traffic::onDifferentLevels(vehicle, ego) ? kOtherLevel : nullptr;
}

LanePlacement placeOnLane(const map::RoadNetwork& network, const traffic::Vehicle& vehicle,
                          const CbvOptions& options) {
  const auto& state = vehicle.state;
  const Eigen::Vector2d preview = previewPoint(state, options.preview_distance);
  const char* failed = failedPreview(
      network, network.lanesNear(preview, state.elevation, kSearchRadius, state.heading),
      options.junction_heading_gate);
  if (failed != nullptr) return {failed, {}};
  const std::optional<map::LanePosition> place = ownLane(network, vehicle);
  if (!place) return {kOffLane, {}};
  return {nullptr, *place};
}

}  // namespace cdiff::cbv
