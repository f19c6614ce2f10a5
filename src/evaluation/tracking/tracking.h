// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "e2e_cdiff/dynamics/bicycle_model.h"
#include "evaluation/tracking/tracks.h"
#include "planning/plan_tracker.h"

namespace cdiff::evaluation {

// How well a tracker follows plans: driven on drawn tracks and measured.

/// Action at a speed [m/s] for a plan in the body frame [rows, 2]; one call per decision.
using Following = std::function<traffic::ControlAction(double, const Eigen::MatrixX2d&)>;

/// A tracker by name, made anew for each track.
struct NamedTracker {
  std::string name;
  std::function<Following()> make;
};

NamedTracker planTracker(const std::string& name, const planning::PlanTrackerOptions& options);
/// PDM-Lite's controllers, with the speed horizon of `tuned`.
NamedTracker pdmLiteTracker();

/// How a tracker drove tracks, over all decisions (SI units).
struct TrackingMeasures {
  std::size_t decisions = 0;
  double lateral = 0.0;           ///< root of the mean squared distance to the line [m]
  double largest_lateral = 0.0;   ///< [m]
  double off_road_percent = 0.0;  ///< decisions with a corner of the box more than 1.75 m off it
  double steer_change = 0.0;      ///< root of the mean squared change from decision to decision
  double speed_error = 0.0;       ///< root of the mean squared difference to Track::speedAt [m/s]

  double unfinished_percent = 0.0;  ///< of the tracks

  /// What tuning minimizes: lateral / 1 m + 0.5 off_road_percent + 0.5 steer_change + 0.1
  /// speed_error / (1 m/s) + 0.1 unfinished_percent.
  double cost() const;
};

/// Drives each track from its start to 4 m before its stop (or for twice its duration), with a plan
/// every 0.1 s and the vehicle dynamics in between. `random` draws what plans are beside the line.
TrackingMeasures drive(const std::vector<Track>& tracks, const NamedTracker& tracker,
                       const dynamics::BicycleModel& model, const core::RandomStream& random);

/// The tracks of one kind.
std::vector<Track> ofKind(const std::vector<Track>& tracks, const std::string& kind);

}  // namespace cdiff::evaluation
