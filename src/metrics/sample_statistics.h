// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Running mean, standard deviation (n - 1) and minimum of samples in one unit; values that are not
/// finite are left out.
#pragma once

#include <cstddef>
#include <string>

#include "e2e_cdiff/metrics/figure.h"

namespace cdiff::metrics {

/// Mean, standard deviation (n - 1) and minimum of defined samples.
struct DistributionMeasure {
  Measure mean;
  Measure standard_deviation;
  Measure minimum;
};

class SampleStatistics {
 public:
  void add(double sample);
  std::size_t count() const { return count_; }
  /// Absent with a reason: mean and minimum without samples (`reason_when_empty`), the deviation
  /// below two.
  DistributionMeasure measure(const std::string& reason_when_empty) const;

 private:
  std::size_t count_ = 0;
  double mean_ = 0.0;
  double squares_ = 0.0;  ///< sum of squared differences to the mean
  double minimum_ = 0.0;
};

}  // namespace cdiff::metrics
