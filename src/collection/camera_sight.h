// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "e2e_cdiff/map/road_network.h"
#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/planning/planner.h"
#include "e2e_cdiff/rendering/camera_options.h"
#include "rendering/rig_renderer.h"

namespace cdiff::collection {

/// Which of the others a vehicle's front camera shows, by the labels of its pixels.
class CameraSight {
 public:
  CameraSight(const rendering::CameraOptions& camera, const map::RoadNetwork& network);

  /// By index of the snapshot's vehicles: whether the camera of `vehicle`, one of the snapshot's or
  /// a copy of one in another place, shows kSeenPixels of it or more. Never of itself.
  std::vector<bool> seenBy(const traffic::Vehicle& vehicle,
                           const traffic::TrafficSnapshot& snapshot);

  /// A vehicle with fewer pixels counts as not seen (LEAD, arXiv 2512.20563, labels vehicles from
  /// five on).
  static constexpr int kSeenPixels = 5;

 private:
  rendering::RigRenderer renderer_;
};

/// Another planner that knows only what the front camera of the vehicle that it drives shows, or
/// showed at most kMemory ago; lights, signs and routes it knows all. The planner keeps its state
/// by vehicle, so each vehicle has one of its own.
class SightedPlanner : public planning::Planner {
 public:
  /// `make`: the planner of one vehicle, which needs no images.
  SightedPlanner(std::function<std::unique_ptr<planning::Planner>()> make,
                 const rendering::CameraOptions& camera, const map::RoadNetwork& network)
      : make_(std::move(make)), sight_(camera, network) {}

  /// What a vehicle has seen is forgotten where it is not among the tasks.
  std::vector<planning::PlannedAction> plan(
      const traffic::TrafficSnapshot& snapshot,
      const std::vector<planning::PlanningTask>& tasks) override;

  static constexpr double kMemory = 1.0;  ///< [s]

 private:
  struct Driver {
    std::unique_ptr<planning::Planner> planner;
    std::map<std::string, double> seen;  ///< when last, by vehicle id [s]
  };
  /// The snapshot without the vehicles that the driver does not know of.
  traffic::TrafficSnapshot known(const traffic::TrafficSnapshot& snapshot,
                                 const traffic::Vehicle& vehicle, Driver& driver);

  std::function<std::unique_ptr<planning::Planner>()> make_;
  CameraSight sight_;
  std::map<std::string, Driver> drivers_;  ///< by vehicle id
};

// Auxiliary targets of training an image encoder: what the image shows of other vehicles. Of order
// 1, and dropped at run time.

/// Names of the targets: `leader_near`, exp(-d / 20 m) of the distance d to the nearest vehicle
/// seen ahead on the route, 0 without one; `leader_relative_speed`, its speed less the own one / 10
/// m/s, not known without one; `occupied_left_R_C` and `occupied_right_R_C`, 1 where the center of
/// a vehicle seen lies in the cell, else 0: rows of 4 m from the own center on, columns of 3.5 m
/// from the own axis to either side.
std::vector<std::string> sightTargets();

/// The targets of `vehicle`, which is at `arc_length` [m] of its route and sees `seen`
/// (CameraSight::seenBy); NaN where not known.
std::vector<float> sightTargetsOf(const traffic::Vehicle& vehicle,
                                  const traffic::TrafficSnapshot& snapshot,
                                  const std::vector<bool>& seen, const map::Route& route,
                                  double arc_length);

}  // namespace cdiff::collection
