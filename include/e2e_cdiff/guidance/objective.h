// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/map/drivable_area.h"
#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::guidance {

/// Another vehicle over the horizon.
struct OtherMotion {
  traffic::VehicleState now;                     ///< its state at this decision
  traffic::VehicleDimensions dimensions;         ///< its box
  std::vector<traffic::VehicleState> predicted;  ///< at rows 1..T, 0.1 s apart
  bool by_same_rules = false;  ///< driven by the same planner, so that it gives way by these rules
  bool goes_first = false;     ///< then: the planned vehicle waits for it
};

/// What guidance objectives know about the planned vehicle and its surroundings at one decision
/// (map frame, SI units).
struct GuidanceScene {
  traffic::VehicleState
      state;  ///< state of the planned vehicle, which is the body frame of rollouts
  traffic::VehicleDimensions dimensions;             ///< its box
  double target_speed = 8.0;                         ///< v* after the lane's limit [m/s]
  const map::DrivableArea* drivable_area = nullptr;  ///< never null
  const map::Route* route = nullptr;                 ///< null: no route
  double route_arc_length = 0.0;                     ///< arc length of the vehicle on its route [m]
  /// The vehicle that collision objectives are about (the ego, for a CBV); null: there is none to
  /// avoid or seek.
  const OtherMotion* other = nullptr;
  std::vector<OtherMotion> traffic;  ///< further vehicles around, on the same level
};

/// Part of a route that a rollout can be near, so that a loop's other pass is not taken [m].
inline constexpr geometry::SearchWindow kRouteReach{10.0, 80.0};

/// Map-frame position of a rollout row.
inline Eigen::Vector2d positionOnMap(const GuidanceScene& scene, const traffic::Rollout& rollout,
                                     Eigen::Index row) {
  return scene.state.pose().toMap(
      {rollout(row, traffic::kRolloutX), rollout(row, traffic::kRolloutY)});
}

/// Adds a gradient with respect to the map-frame position to a rollout row's x and y.
inline void addPositionGradient(const GuidanceScene& scene, const Eigen::Vector2d& on_map,
                                Eigen::Index row, traffic::Rollout& gradient) {
  const Eigen::Vector2d forward = geometry::direction(scene.state.heading);
  gradient(row, traffic::kRolloutX) += forward.dot(on_map);
  gradient(row, traffic::kRolloutY) += geometry::leftNormal(forward).dot(on_map);
}

/// A guidance objective J(tau^0): what sampling minimizes (paper III-D), with its analytic gradient
/// with respect to states and actions in metric units.
/// Besides its options it holds what `prepare` found in the scene of one decision; one row per
/// objective in the table of objectives.
class Objective {
 public:
  virtual ~Objective() = default;
  /// Its own options (weight, window and cap are described by WeightedObjective).
  virtual void describe(core::OptionsVisitor& visitor) = 0;
  /// Throws InputError naming the option.
  virtual void validate() const {}
  /// Called once a decision, before `evaluate` of the same scene and before the samples of that
  /// decision get their clones: for what depends on the scene alone.
  virtual void prepare(const GuidanceScene&) {}
  /// J of a metric rollout (body frame of `scene`), summed over its rows; adds dJ/d(rollout) to
  /// `gradient` (same shape). The states are independent variables here: the state branch joins
  /// them to the actions.
  virtual double evaluate(const GuidanceScene& scene, const traffic::Rollout& rollout,
                          traffic::Rollout& gradient) const = 0;
  /// A copy with its options and what `prepare` found.
  virtual std::unique_ptr<Objective> clone() const = 0;
};

/// What is known about a guidance objective before one is made.
struct ObjectiveDescriptor {
  std::string name;                                  ///< in guidance profiles, snake_case
  std::string help;                                  ///< one sentence: what a plan does to lower it
  std::function<std::unique_ptr<Objective>()> make;  ///< one with default options
};

}  // namespace cdiff::guidance
