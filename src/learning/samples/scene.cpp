// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/samples/scene.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::learning {

void SceneSampleOptions::describe(core::OptionsVisitor& visitor) {
  visitor.number({"period", "s", "Between two samples of a vehicle."}, period, 0.1, 60.0);
  visitor.number({"standing_share", "", "Part kept of samples at which the vehicle stands."},
                 standing_share, 0.0, 1.0);
  visitor.number({"lowest_target_speed", "m/s", "Drivers with a lower target speed are left out."},
                 lowest_speed, 0.0, 100.0);
  visitor.number({"highest_target_speed", "m/s", "Drivers with a higher one are left out."},
                 highest_speed, 0.0, 100.0);
}

std::size_t SceneSampleOptions::stride() const {
  return static_cast<std::size_t>(std::max(1L, std::lround(period / kScenePeriod)));
}

void requireScenePeriod(const Scene& scene, const std::string& learner) {
  for (std::size_t i = 1; i < scene.decisions.size(); ++i) {
    const double step = scene.decisions[i].time - scene.decisions[i - 1].time;
    if (std::abs(step - kScenePeriod) < 1e-6) continue;
    throw core::InputError("scene '" + scene.name + "': decisions " + std::to_string(i - 1) +
                           " and " + std::to_string(i) + " are " + core::formatNumber(step) +
                           " s apart; " + learner +
                           " from decisions 0.1 s apart: collect it "
                           "with decision_period 0.1");
  }
}

bool drivesOn(const traffic::VehicleState& before, const traffic::VehicleState& after) {
  constexpr double kJump = 0.5;  // [m]
  const double moved = (after.position - before.position).norm();
  const double expected = 0.5 * kScenePeriod * (after.speed + before.speed);
  return std::abs(moved - expected) <= kJump;
}

map::Route routeOf(const Scene& scene, const SceneDrive& drive, const map::RoadNetwork& network) {
  std::vector<map::LaneIndex> lanes;
  lanes.reserve(drive.route_lanes.size());
  for (const std::string& id : drive.route_lanes) {
    lanes.push_back(network.findLane(id));
    if (lanes.back() != map::kNoLane) continue;
    throw core::InputError("scene '" + scene.name + "': the route of vehicle '" + drive.vehicle_id +
                           "' uses lane '" + id + "', which its network lacks");
  }
  return map::Route(network, drive.route_points, lanes);
}

}  // namespace cdiff::learning
