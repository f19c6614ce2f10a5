// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The distribution that speeds of CBVs [m/s] are compared with: the 1-Wasserstein distance to
/// background vehicles of the session, to a normal distribution, or to given samples.
#pragma once

#include <vector>

#include "metrics/metrics_options.h"
#include "metrics/session_measures.h"

namespace cdiff::metrics {

class SpeedTarget {
 public:
  /// Throws InputError for samples that are no numbers.
  explicit SpeedTarget(const MetricsOptions& options);

  /// Speed of a background vehicle at a decision [m/s]; used by the target `background` alone.
  void addBackground(double speed);
  /// W1 [m/s] with `target` set in every case; absent with a reason without speeds or target.
  Measure distanceFrom(const std::vector<double>& speeds) const;

 private:
  std::string name() const;

  MetricsOptions options_;
  std::vector<double> samples_;
};

}  // namespace cdiff::metrics
