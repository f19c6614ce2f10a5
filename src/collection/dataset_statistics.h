// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "e2e_cdiff/core/angle.h"
#include "learning/samples/driving_sample.h"
#include "session/session_setup.h"

namespace cdiff::collection {

/// What the sessions or bags of a data set gave: images, samples and kinds of driving, counted. All
/// are sums, so that those of several bags add up.
struct DatasetStatistics {
  std::uint64_t images = 0;
  std::uint64_t samples = 0;
  std::map<std::string, std::uint64_t> dropped;       ///< images that yielded no sample, by reason
  std::map<std::string, std::uint64_t> maneuvers;     ///< samples: straight, left, right, other
  std::map<std::string, std::uint64_t> stop_reasons;  ///< samples: none, light, leader, ...
  /// Samples: standing, starting, stopping, recovering, displaced, off_road, off_course,
  /// in_junction.
  std::map<std::string, std::uint64_t> kinds;
  std::array<std::uint64_t, 8> speeds{};  ///< samples by speed, 2 m/s a bin, the last open
  double steer_sum = 0.0;                 ///< sum of each sample's mean |steer|
  std::uint64_t contacts = 0;             ///< contacts of driven vehicles
  double seconds = 0.0;                   ///< simulated

  void add(const DatasetStatistics& other);
};

/// As JSON text and back; throws InputError naming the file.
std::string toJson(const DatasetStatistics& statistics);
DatasetStatistics readStatistics(const std::filesystem::path& file);

/// Of several sessions or bags, by name.
using StatisticsByName = std::map<std::string, DatasetStatistics>;
DatasetStatistics sumOf(const StatisticsByName& statistics);

// What a data set holds, in words and pictures.

/// Writes statistics.json and, where there are shards, samples.html into the data set's folder, and
/// the statistics as a table to the output.
void describeDataset(const std::filesystem::path& folder, const DatasetStatistics& statistics);

/// Prints to standard error each "session" or "bag" (`kind`) that yielded no sample, with what
/// became of its images and, where they lie too near its end, the `remedy` ("longer bags"). Throws
/// InputError when none gave any.
void requireSamples(const StatisticsByName& statistics, const std::string& kind,
                    const std::string& remedy);

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
  bool planned = false;     ///< the rollout is a plan (PolicyPlans)
  bool displaced = false;   ///< put beside its route (DisplacedSamples)
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
