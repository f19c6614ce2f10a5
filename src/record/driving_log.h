// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// How fast CBVs and background vehicles drove and accelerated: histograms over all decisions and
/// vehicles, of speed [m/s] and acceleration [m/s^2].
#pragma once

#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "record/histogram.h"

namespace cdiff::record {

class DrivingLog {
 public:
  struct Role {
    Histogram speed{0.0, 0.5, 70};           ///< to 35 m/s
    Histogram acceleration{-8.0, 0.25, 64};  ///< to 8 m/s^2
  };
  /// Every tick in order; decisions count.
  void observe(const traffic::TrafficSnapshot& snapshot);
  const Role& cbv() const { return cbv_; }
  const Role& background() const { return background_; }

 private:
  Role cbv_;
  Role background_;
};

}  // namespace cdiff::record
