// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <string>

#include "e2e_cdiff/metrics/metric.h"

namespace cdiff::metrics {

/// Mean, standard deviation (n - 1) and minimum of defined samples.
struct DistributionMeasure {
  Measure mean;
  Measure standard_deviation;
  Measure minimum;
};

/// Running mean, standard deviation (n - 1) and minimum of samples in one unit; values that are not
/// finite are left out.
class SampleStatistics {
 public:
  void add(double sample);
  std::size_t count() const { return count_; }
  std::optional<double> mean() const;               ///< absent without samples
  std::optional<double> standardDeviation() const;  ///< absent below two
  /// Absent with a reason: mean and minimum without samples (`reason_when_empty`), the deviation
  /// below two.
  DistributionMeasure measure(const std::string& reason_when_empty) const;

 private:
  std::size_t count_ = 0;
  double mean_ = 0.0;
  double squares_ = 0.0;  ///< sum of squared differences to the mean
  double minimum_ = 0.0;
};

/// Share of ticks of equal length at which something held [%]: 100 x ticks where it did / ticks.
class TickShare {
 public:
  void add(bool held);
  std::size_t ticks() const { return ticks_; }
  /// In percent, with n = ticks; without any tick absent with `reason_when_empty`.
  Measure measure(const std::string& reason_when_empty) const;

 private:
  std::size_t ticks_ = 0;
  std::size_t held_ticks_ = 0;
};

// What the shipped metrics say in the same words.

/// Reason of every CBV measure of a session without CBVs.
inline constexpr const char* kNoCbv = "no CBV was driven";
/// Reason of the ego's measures of a session without ego.
inline constexpr const char* kNoEgo = "the ego was never seen";

/// A value of the session as a whole.
inline Measure numberMeasure(double value) { return {value, 1, {}, {}}; }
inline Measure countMeasure(std::size_t count) { return numberMeasure(static_cast<double>(count)); }
inline Measure absentMeasure(const std::string& reason) { return {std::nullopt, 0, {}, reason}; }
inline Measure measureOrReason(const std::optional<double>& value, std::size_t n,
                               const char* reason) {
  return {value, n, {}, value ? "" : reason};
}

/// The distance [m] that all CBVs drove as CBVs: chords between successive ticks.
class CbvTravel {
 public:
  void observe(const MetricTick& tick) {
    for (const CbvSighting& cbv : tick.cbvs) {
      if (!cbv.placed()) continue;
      driven_.insert(cbv.vehicle->id);
      distance_ += cbv.chord;
    }
  }
  /// Of all CBVs together [m].
  double distance() const { return distance_; }
  /// Vehicles that were CBVs.
  std::size_t vehicles() const { return driven_.size(); }

 private:
  std::set<std::string> driven_;
  double distance_ = 0.0;
};

// Collisions per kilometer (paper's CPK) [1/km]: 1000 x collisions / meters driven.

/// 1000 x `count` / `distance` [m], n = `n`; absent with the reason where nobody moved.
Measure countPerKilometer(std::size_t count, double distance, std::size_t n, const char* reason);

/// n = `vehicles` that drove. Absent with a reason when there was none, or none moved.
Measure collisionsPerKilometer(std::size_t collisions, double distance, std::size_t vehicles);

}  // namespace cdiff::metrics
