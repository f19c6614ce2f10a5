// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "evaluation/tracking/tracking.h"

namespace cdiff::evaluation {

// Tunes the constants of a tracker of plans on drawn tracks (`cdiff tune`).

/// What is tuned, and on how much.
struct TuningOptions {
  std::int64_t seed = 1;  ///< of the tracks and of what plans are beside them
  int each = 12;          ///< tracks of each kind, to tune on and as many others to judge by
};

/// The tracks to tune on, and others, of streams of their own.
struct TuningTracks {
  core::RandomStream random;  ///< of plans
  std::vector<Track> tuning;
  std::vector<Track> held_out;

  explicit TuningTracks(const TuningOptions& options);
};

/// A key of PlanTrackerOptions and the values that are tried.
struct TunedKey {
  std::string key;
  std::vector<double> values;
};

/// Gains of the steering, the place aimed at, the speed horizon, steering while braking. Gains of
/// the throttle and the rules for braking stay as published.
const std::vector<TunedKey>& tunedKeys();

/// "turn_kp: 1.5\n": the key with its value in `options`.
std::string valueLine(const TunedKey& key, const planning::PlanTrackerOptions& options);

/// Coordinate descent on the cost of the tuning tracks, from the published values: each key in turn
/// takes the best of its values, until none changes. Deterministic.
planning::PlanTrackerOptions tuneTracker(const TuningTracks& tracks,
                                         const dynamics::BicycleModel& model);

/// A tracker on the tracks that it was, and was not, tuned on.
struct TrackerRow {
  std::string name;
  TrackingMeasures tuning;
  TrackingMeasures held_out;
  std::vector<TrackingMeasures> by_kind;  ///< of the held-out tracks, in the order of trackKinds()
};

TrackerRow evaluateTracker(const NamedTracker& tracker, const TuningTracks& tracks,
                           const dynamics::BicycleModel& model);

/// Markdown: a line per tracker.
std::string tuningTable(const std::vector<TrackerRow>& rows);
/// The same as comma-separated values: a line per tracker, set and kind ("all": all of them).
std::string tuningCsv(const std::vector<TrackerRow>& rows);

}  // namespace cdiff::evaluation
