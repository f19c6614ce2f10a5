// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "e2e_cdiff/core/random.h"
#include "planners/pluto/training/pluto_samples.h"

namespace cdiff::planners {

/// What the network is given of a moment, and what it is to answer.
struct PlutoExample {
  PlutoInput input;
  PlutoTarget target;
  std::vector<AgentFuture> futures;  ///< of input.agents, in their order
  const PlutoWorld* world = nullptr;
  geometry::Pose2d frame;  ///< that the input is in (map frame)
  traffic::VehicleDimensions size;
  bool imitates = true;  ///< false: a negative, which has no target
};

/// A moment that is another than the recorded one; holds what its `moment` points to.
struct ChangedMoment {
  VehicleTable vehicles;
  std::vector<TrackFrame> frames;
  std::vector<traffic::SignalState> signals;
  PlutoMoment moment;

  explicit ChangedMoment(const PlutoMoment& from);
  ChangedMoment(const ChangedMoment&) = delete;
  ChangedMoment& operator=(const ChangedMoment&) = delete;
  TrackPoint& own();
  /// Removes vehicles from all frames.
  void remove(const std::set<std::uint32_t>& gone);
};

PlutoExample plutoExample(const PlutoScene& scene, const PlutoPlace& place,
                          const PlutoMoment& moment, bool imitates);

/// Draws of one sample at one step.
struct ExampleDraws {
  const core::RandomStream& random;
  core::RandomKey key;

  double uniform(std::uint32_t element, double low, double high) const {
    return random.uniform(key, element, low, high);
  }
};

/// Vehicles whose boxes lie, within the next 4 s, where that of the driven one lies then or at
/// another time (Cheng et al. 2024, III-D): it follows them, waits for them or crosses their way.
std::set<std::uint32_t> interactingVehicles(const PlutoScene& scene, const PlutoPlace& place);

/// The largest changes of a vehicle's own state.
struct OwnDisturbance {
  double along = 1.0;         ///< [m]
  double across = 0.75;       ///< [m]
  double turn = 0.35;         ///< [rad]
  double speed = 1.0;         ///< [m/s]
  double acceleration = 0.5;  ///< [m/s^2]
  double steer = 0.2;
};

/// Changes the own state by up to `most`, evenly drawn, halved up to five times until the box is
/// free of others, then not at all; the place on the route follows.
void disturbOwn(ChangedMoment& changed, const OwnDisturbance& most, const ExampleDraws& draws);

/// A moment in which the same way is right: place, heading, speed, acceleration and steer change by
/// up to OwnDisturbance's defaults; half of them lose 10 to 100 % of the vehicles that do not
/// interact.
std::unique_ptr<ChangedMoment> positiveMoment(const PlutoScene& scene, const PlutoPlace& place,
                                              const ExampleDraws& draws);

/// A moment in which another way is right: the red light that it waits for is green; else the
/// vehicles that it interacts with are gone, or, half of the time and where there is none, a slower
/// one drives ahead on the route. nullptr where none applies.
std::unique_ptr<ChangedMoment> negativeMoment(const PlutoScene& scene, const PlutoPlace& place,
                                              const ExampleDraws& draws);

}  // namespace cdiff::planners
