// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "metrics/measures/sample_statistics.h"

namespace cdiff::record {

/// A sample counted in bins of equal width, with its mean and standard deviation (n - 1, Welford
/// 1962); values beyond the ends count in the outermost bins, values that are not finite nowhere.
class Histogram {
 public:
  /// `bins` (at least 1) bins of `width` (positive), the first from `low`.
  Histogram(double low, double width, std::size_t bins);
  void add(double value);

  double low() const { return low_; }
  double width() const { return width_; }
  std::size_t n() const { return statistics_.count(); }
  const std::vector<std::size_t>& counts() const { return counts_; }
  /// Share of the sample in a bin; 0 when the sample is empty.
  double share(std::size_t bin) const;
  /// Of the values themselves, not of their bins; absent when n = 0.
  std::optional<double> mean() const { return statistics_.mean(); }
  /// Likewise, with n - 1; absent when n < 2.
  std::optional<double> standardDeviation() const { return statistics_.standardDeviation(); }

 private:
  double low_;
  double width_;
  std::vector<std::size_t> counts_;
  metrics::SampleStatistics statistics_;
};

/// How fast CBVs and background vehicles drove and accelerated: histograms over all decisions and
/// vehicles, of speed [m/s] and acceleration [m/s^2].
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
