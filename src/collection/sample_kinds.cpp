// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "collection/sample_kinds.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "e2e_cdiff/core/angle.h"
#include "learning/samples/sample_order.h"
#include "planners/pdm_lite/route_rules.h"

namespace cdiff::collection {
namespace {

using learning::kMoving;
using learning::kStanding;

constexpr double kTurn = core::degreesToRadians(15.0);  // of heading over the horizon [rad]

constexpr const char* kManeuvers[] = {"straight", "left", "right", "other"};
constexpr const char* kStopReasons[] = {"none", "light", "leader", "yielding", "other"};
static_assert(std::size(kStopReasons) == learning::kStopOther + 1);

std::uint8_t maneuverOf(const learning::DrivingSample& sample, bool standing) {
  const double turned = sample.rollout(sample.rollout.rows() - 1, traffic::kRolloutHeading);
  if (standing) return 3;
  if (turned > kTurn) return 1;
  return turned < -kTurn ? 2 : 0;
}

/// For a sample that comes to stand or stands.
std::uint8_t stopReasonOf(const SampleSurroundings& around, const std::string& id) {
  constexpr double kLightDistance = 40.0;     // [m]
  constexpr double kLeaderDistance = 25.0;    // [m]
  constexpr double kJunctionDistance = 25.0;  // [m]
  const traffic::Vehicle& self = *around.snapshot.find(id);
  for (const traffic::Vehicle& other : around.snapshot.vehicles) {
    const double distance = (other.state.position - self.state.position).norm();
    if (other.id == id || distance > kLeaderDistance || traffic::onDifferentLevels(self, other))
      continue;
    if (planners::isLeading(around.route, around.arc_length, other.state))
      return learning::kStopLeader;
  }
  const auto light = planners::distanceToRedLight(around.route, around.arc_length, around.snapshot);
  if (light && *light < kLightDistance) return learning::kStopLight;
  for (const auto& [from, to] : around.route.junctionStretches()) {
    if (to >= around.arc_length && from <= around.arc_length + kJunctionDistance)
      return learning::kStopYielding;
  }
  return learning::kStopOther;
}

}  // namespace

SampleKinds kindsOf(const learning::DrivingSample& sample) {
  SampleKinds kinds;
  const auto speeds = sample.rollout.col(traffic::kRolloutSpeed);
  const double last = speeds(speeds.size() - 1);
  kinds.standing = sample.speed < kStanding && speeds.maxCoeff() < kStanding;
  kinds.starting = sample.speed < kStanding && last > kMoving;
  kinds.stopping = sample.speed > kMoving && speeds.minCoeff() < kStanding;
  kinds.maneuver = maneuverOf(sample, kinds.standing);
  const bool stops = std::min(sample.speed, speeds.minCoeff()) < kStanding && !kinds.starting;
  kinds.stop_reason = stops ? learning::kStopOther : learning::kStopNone;
  return kinds;
}

SampleKinds kindsOf(const learning::DrivingSample& sample, const SampleSurroundings& around) {
  SampleKinds kinds = kindsOf(sample);
  const traffic::VehicleState& state = around.snapshot.find(sample.vehicle)->state;
  if (kinds.stop_reason != learning::kStopNone)
    kinds.stop_reason = stopReasonOf(around, sample.vehicle);
  kinds.off_road = !around.setup.drivableArea().contains(state.position, state.elevation);
  kinds.in_junction = around.route.inJunctionAt(around.arc_length);
  kinds.off_course = offCourse(around, state);
  return kinds;
}

bool offCourse(const SampleSurroundings& around, const traffic::VehicleState& state) {
  const double s = std::clamp(around.arc_length, 0.0, around.route.length());
  const double lateral = (around.route.path().positionAt(s) - state.position).norm();
  const double turned =
      std::abs(core::angleDifference(state.heading, around.route.path().headingAt(s)));
  return lateral > kOffCourse || turned > kOffTurn;
}

void count(const learning::DrivingSample& sample, const SampleKinds& kinds,
           DatasetStatistics& statistics) {
  ++statistics.maneuvers[kManeuvers[kinds.maneuver]];
  ++statistics.stop_reasons[kStopReasons[kinds.stop_reason]];
  const std::pair<const char*, bool> flags[] = {
      {"standing", kinds.standing},       {"starting", kinds.starting},
      {"stopping", kinds.stopping},       {"off_road", kinds.off_road},
      {"in_junction", kinds.in_junction}, {"off_course", kinds.off_course},
      {"recovering", sample.recovering},  {"displaced", kinds.displaced}};
  for (const auto& [name, is] : flags) statistics.kinds[name] += is;
  const auto bin = static_cast<std::size_t>(std::max(0.0, sample.speed / 2.0));
  ++statistics.speeds[std::min(bin, statistics.speeds.size() - 1)];
  statistics.steer_sum += sample.rollout.col(traffic::kRolloutSteer).cwiseAbs().mean();
}

}  // namespace cdiff::collection
