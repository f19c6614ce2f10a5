// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "collection/displaced_samples.h"

#include <algorithm>

#include "diffusion/network/architecture.h"
#include "e2e_cdiff/core/angle.h"
#include "planners/pdm_lite/lateral_controller.h"
#include "planners/pdm_lite/pdm_lite_options.h"
#include "planning/route_follower.h"

namespace cdiff::collection {

DisplacedSamples::DisplacedSamples(const session::SessionSetup& setup,
                                   const DatasetOptions& options)
    : setup_(setup),
      options_(options),
      model_(setup.options().vehicle),
      camera_(setup.options().camera, setup.network()),
      sight_(setup.options().camera, setup.network()) {}

traffic::VehicleState displacedAlike(const traffic::VehicleState& state,
                                     const traffic::VehicleState& here,
                                     const traffic::VehicleState& displaced) {
  traffic::VehicleState alike = state;
  alike.position = displaced.pose().toMap(here.pose().toBody(state.position));
  alike.heading = core::wrapAngle(state.heading + displaced.heading - here.heading);
  return alike;
}

bool DisplacedSamples::free(const traffic::Vehicle& vehicle,
                            const traffic::TrafficSnapshot& snapshot) const {
  const geometry::OrientedBox box = vehicle.box();
  if (setup_.drivableArea().signedDistance(box, vehicle.state.elevation) < 0.0) return false;
  return std::none_of(
      snapshot.vehicles.begin(), snapshot.vehicles.end(), [&](const traffic::Vehicle& other) {
        return other.id != vehicle.id && !traffic::onDifferentLevels(vehicle, other) &&
               geometry::overlap(box, other.box());
      });
}

bool DisplacedSamples::driveBack(traffic::Vehicle vehicle, const SampleSurroundings& around,
                                 const std::vector<const traffic::TrafficSnapshot*>& future,
                                 traffic::Rollout& rollout) const {
  const traffic::VehicleState start = vehicle.state;
  planners::LateralController controller(
      setup_.options().planner_options.of<planners::PdmLiteOptions>());
  double arc_length = around.arc_length;
  double heading = 0.0;  // since the start, not wrapped
  for (std::size_t t = 0; t < future.size(); ++t) {
    traffic::VehicleState& state = vehicle.state;
    const double reach = std::max(1.0, state.speed);
    arc_length = planning::extendedProjection(around.route, state.position, arc_length - reach,
                                              arc_length + reach);
    const double aim_arc_length = arc_length + planners::lookAheadDistance(state.speed);
    auto row = rollout.row(static_cast<Eigen::Index>(t));
    // Throttle and brake as recorded; steering toward the route.
    const traffic::ControlAction action{
        row(traffic::kRolloutThrottle),
        controller.steer(state.pose(), around.route.path().extendedPoseAt(aim_arc_length).position),
        row(traffic::kRolloutBrake)};
    const double previous_heading = state.heading;
    state = model_.step(state, action, traffic::kRolloutStep);
    state.elevation = future[t]->find(vehicle.id)->state.elevation;
    heading += core::angleDifference(state.heading, previous_heading);
    const Eigen::Vector2d position = start.pose().toBody(state.position);
    row << position.x(), position.y(), heading, state.speed, action.throttle, action.steer,
        action.brake;
    if (!free(vehicle, *future[t])) return false;
  }
  return true;
}

std::optional<DisplacedSample> DisplacedSamples::displace(
    const learning::DrivingSample& sample, const SampleSurroundings& around,
    const traffic::TrafficSnapshot& previous,
    const std::vector<const traffic::TrafficSnapshot*>& future, const SampleOffset& offset) {
  traffic::Vehicle vehicle = *around.snapshot.find(sample.vehicle);
  vehicle.state.position +=
      offset.lateral * geometry::leftNormal(geometry::direction(vehicle.state.heading));
  vehicle.state.heading = core::wrapAngle(vehicle.state.heading + offset.heading);
  if (!free(vehicle, around.snapshot)) return std::nullopt;
  DisplacedSample found{sample, offCourse(around, vehicle.state)};
  learning::DrivingSample& displaced = found.sample;
  if (!driveBack(vehicle, around, future, displaced.rollout)) return std::nullopt;
  displaced.recovering = true;
  displaced.image = camera_.render(around.snapshot, vehicle);
  displaced.auxiliary = targets(vehicle, around);
  if (!sample.previous_image.empty()) {
    const traffic::Vehicle& before = *previous.find(sample.vehicle);
    const traffic::VehicleState& here = around.snapshot.find(sample.vehicle)->state;
    displaced.previous_image =
        seen(previous, before, displacedAlike(before.state, here, vehicle.state));
  }
  displaced.route = diffusion::routeTokens(options_.architecture, around.route.path(),
                                           around.arc_length, vehicle.state.pose());
  return found;
}

}  // namespace cdiff::collection
