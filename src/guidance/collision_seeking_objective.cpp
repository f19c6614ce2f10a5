// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "guidance/collision_seeking_objective.h"

#include "guidance/right_of_way.h"

namespace cdiff::guidance {
namespace {

/// Whether all of the other vehicle is behind the planned one, and does not come.
bool standsBehind(const GuidanceScene& scene) {
  constexpr double kStands = 0.5;  // [m/s]
  const traffic::VehicleState& other = scene.other->now;
  const Eigen::Vector2d forward = geometry::direction(scene.state.heading);
  const double front = forward.dot(other.position - scene.state.position) +
                       geometry::halfExtent(boxOf(other.pose(), scene.other->dimensions), forward);
  return other.speed < kStands && front < -0.5 * scene.dimensions.length;
}

}  // namespace

void CollisionSeekingObjective::describe(core::OptionsVisitor& visitor) {
  proximity.describe(visitor);
  visitor.text({"gate", "", "How the pull sets in at the trigger distance."}, gate,
               {"smooth", "hard"});
  visitor.number({"trigger_distance", "m", "Distance now up to which it acts fully."},
                 trigger_distance, 0.0, 500.0);
  visitor.number({"trigger_width", "m", "Distance beyond it over which the smooth gate closes."},
                 trigger_width, 0.01, 500.0);
  visitor.flag({"leave_behind", "", "Whether to drive on from a vehicle that stands behind."},
               leave_behind);
}

double CollisionSeekingObjective::gateAt(double distance) const {
  const double beyond = distance - trigger_distance;
  if (beyond <= 0.0) return 1.0;
  if (gate == "hard" || beyond >= trigger_width) return 0.0;
  const double share = beyond / trigger_width;
  return 1.0 - share * share * (3.0 - 2.0 * share);
}

double CollisionSeekingObjective::evaluate(const GuidanceScene& scene,
                                           const traffic::Rollout& rollout,
                                           traffic::Rollout& gradient) const {
  if (scene.other == nullptr) return 0.0;
  if (leave_behind && standsBehind(scene)) return 0.0;
  const double eta = gateAt((scene.other->now.position - scene.state.position).norm());
  if (eta <= 0.0) return 0.0;
  return proximity.evaluate(scene, rollout, -eta, gradient);
}

std::unique_ptr<Objective> CollisionSeekingObjective::clone() const {
  return std::make_unique<CollisionSeekingObjective>(*this);
}

}  // namespace cdiff::guidance
