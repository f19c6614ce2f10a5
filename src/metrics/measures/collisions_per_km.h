// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <set>
#include <string>

#include "e2e_cdiff/metrics/metric.h"

namespace cdiff::metrics {

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
Measure countPerKilometre(std::size_t count, double distance, std::size_t n, const char* reason);

/// n = `vehicles` that drove. Absent with a reason when there was none, or none moved.
Measure collisionsPerKilometre(std::size_t collisions, double distance, std::size_t vehicles);

}  // namespace cdiff::metrics
