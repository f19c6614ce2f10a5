// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "collection/dataset_statistics.h"
#include "e2e_cdiff/core/angle.h"
#include "learning/samples/driving_sample.h"
#include "session/session_setup.h"

namespace cdiff::collection {

/// What surrounds the vehicle of a sample at planning time.
struct SampleSurroundings {
  const session::SessionSetup& setup;
  const traffic::TrafficSnapshot& snapshot;
  const map::Route& route;
  double arc_length = 0.0;  ///< on the route [m]
};

constexpr double kOffCourse = 0.4;                        // [m]
constexpr double kOffTurn = core::degreesToRadians(5.0);  // [rad]

/// What happens in a sample, for the statistics and the sample's own labels.
struct SampleKinds {
  std::uint8_t maneuver = 0;                       ///< as Sample::maneuver
  std::uint8_t stop_reason = learning::kStopNone;  ///< as Sample::stop_reason
  bool standing = false;                           ///< all the time
  bool starting = false;                           ///< from standing to more than 2 m/s
  bool stopping = false;                           ///< from more than 2 m/s to standing
  bool off_road = false;                           ///< its center at planning time
  bool in_junction = false;
  bool off_course = false;  ///< more than kOffCourse or kOffTurn off its route
  bool displaced = false;   ///< put beside its route (OffsetSamples)
};

SampleKinds kindsOf(const learning::DrivingSample& sample, const SampleSurroundings& surroundings);
/// Whether `state` is more than kOffCourse or kOffTurn off the route at `around.arc_length`.
bool offCourse(const SampleSurroundings& around, const traffic::VehicleState& state);
/// What its motion alone shows; the reason for a stop is "other".
SampleKinds kindsOf(const learning::DrivingSample& sample);

/// Adds a sample to the statistics.
void count(const learning::DrivingSample& sample, const SampleKinds& kinds,
           DatasetStatistics& statistics);

}  // namespace cdiff::collection
