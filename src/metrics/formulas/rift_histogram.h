// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace cdiff::metrics {

/// A histogram as RIFT's statistics keep it: bins (left, right] in the values' unit, values below
/// the first or not below the last edge dropped, mean and variance from the bins' midpoints, and
/// RIFT's resampling with a fixed stream.
class RiftHistogram {
 public:
  /// `edges` ascending, at least two.
  explicit RiftHistogram(std::vector<double> edges);

  /// Counts a value `times` times; one outside the edges, or not finite, is dropped.
  void add(double value, std::uint64_t times = 1);
  /// Adds the counts of a histogram with the same edges.
  void add(const RiftHistogram& other);

  const std::vector<double>& edges() const { return edges_; }
  const std::vector<std::uint64_t>& counts() const { return counts_; }
  std::uint64_t total() const;
  /// Of the bins' midpoints; nullopt when nothing was counted.
  std::optional<double> mean() const;
  /// E[mid^2] - E[mid]^2, not below 0; nullopt when nothing was counted.
  std::optional<double> variance() const;
  /// `size` values as RIFT draws them (NumPy's legacy stream, seed 0): all bins first, by the
  /// cumulated shares, then a uniform place inside each value's bin. Zeros when nothing was
  /// counted.
  std::vector<double> resample(std::size_t size) const;

 private:
  double midpoint(std::size_t bin) const { return 0.5 * (edges_[bin] + edges_[bin + 1]); }
  std::vector<double> edges_;
  std::vector<std::uint64_t> counts_;
};

/// RIFT's bins of speed [m/s].
RiftHistogram riftSpeedHistogram();
/// RIFT's bins of the magnitude of acceleration [m/s^2].
RiftHistogram riftAccelerationHistogram();
/// RIFT's bins of jerk [m/s^3].
RiftHistogram riftJerkHistogram();
/// RIFT's bins of the time to collision and of ACT [s].
RiftHistogram riftTtcHistogram();

/// RIFT's S-WD [m/s]: 2-Wasserstein distance of two normal distributions, sqrt((mean - 8.5)^2 +
/// deviation^2); its target is CARLA's default limit of 30 km/h, which falls into the bin 8 to 9
/// m/s.
double riftSpeedWasserstein(double mean, double standard_deviation);

}  // namespace cdiff::metrics
