// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/formulas/rift_histogram.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::metrics {
namespace {

/// NumPy's legacy stream with seed 0. The standard fixes every output of mt19937; the conversion to
/// [0, 1) is NumPy's.
class LegacyStream {
 public:
  double next() {
    const double high = static_cast<double>(engine_() >> 5U);
    const double low = static_cast<double>(engine_() >> 6U);
    return (high * 67108864.0 + low) / 9007199254740992.0;  // 2^26 and 2^53
  }

 private:
  std::mt19937 engine_{0};
};

}  // namespace

RiftHistogram::RiftHistogram(std::vector<double> edges)
    : edges_(std::move(edges)), counts_(edges_.empty() ? 0 : edges_.size() - 1, 0) {
  if (counts_.empty() || !std::is_sorted(edges_.begin(), edges_.end())) {
    throw core::InputError("a histogram needs at least two ascending edges, got " +
                           std::to_string(edges_.size()));
  }
}

void RiftHistogram::add(double value, std::uint64_t times) {
  if (!(value >= edges_.front()) || !(value < edges_.back())) return;
  const auto edge = std::lower_bound(edges_.begin(), edges_.end(), value) - edges_.begin();
  counts_[static_cast<std::size_t>(std::max<std::ptrdiff_t>(edge - 1, 0))] += times;
}

void RiftHistogram::add(const RiftHistogram& other) {
  if (other.edges_ != edges_) {
    throw core::InputError("histograms with different edges cannot be added");
  }
  for (std::size_t i = 0; i < counts_.size(); ++i) counts_[i] += other.counts_[i];
}

std::uint64_t RiftHistogram::total() const {
  return std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0});
}

std::optional<double> RiftHistogram::mean() const {
  const std::uint64_t count = total();
  if (count == 0) return std::nullopt;
  double sum = 0.0;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    sum += static_cast<double>(counts_[i]) * midpoint(i);
  }
  return sum / static_cast<double>(count);
}

std::optional<double> RiftHistogram::variance() const {
  const auto center = mean();
  if (!center) return std::nullopt;
  double squares = 0.0;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    squares += static_cast<double>(counts_[i]) * midpoint(i) * midpoint(i);
  }
  return std::max(0.0, squares / static_cast<double>(total()) - *center * *center);
}

std::vector<double> RiftHistogram::resample(std::size_t size) const {
  std::vector<double> values(size, 0.0);
  const std::uint64_t count = total();
  if (count == 0) return values;
  std::vector<double> cumulated(counts_.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    sum += static_cast<double>(counts_[i]) / static_cast<double>(count);
    cumulated[i] = sum;
  }
  LegacyStream stream;
  std::vector<std::size_t> bins(size);
  for (std::size_t& bin : bins) {
    const auto found = std::lower_bound(cumulated.begin(), cumulated.end(), stream.next());
    bin = std::min<std::size_t>(static_cast<std::size_t>(found - cumulated.begin()),
                                counts_.size() - 1);
  }
  for (std::size_t i = 0; i < size; ++i) {
    const double width = edges_[bins[i] + 1] - edges_[bins[i]];
    values[i] = edges_[bins[i]] + width * stream.next();
  }
  return values;
}

RiftHistogram riftSpeedHistogram() {
  return RiftHistogram({0, 0.5, 1, 1.5, 2, 2.5, 3, 4, 6, 8, 10, 12, 14});
}

RiftHistogram riftAccelerationHistogram() {
  return RiftHistogram({-1.5, -1, -0.5, -0.25, 0, 0.25, 0.5, 0.75, 1, 1.25, 1.5, 2, 2.5, 3});
}

RiftHistogram riftJerkHistogram() {
  return RiftHistogram({-10, -8, -6, -4, -2, 0, 2, 4, 6, 8, 10});
}

RiftHistogram riftTtcHistogram() {
  return RiftHistogram({0, 0.5, 1, 1.5, 2, 2.5, 3, 3.5, 4, 4.5, 5});
}

double riftSpeedWasserstein(double mean, double standard_deviation) {
  constexpr double kTargetMean = 8.5;
  return std::hypot(mean - kTargetMean, standard_deviation);
}

}  // namespace cdiff::metrics
