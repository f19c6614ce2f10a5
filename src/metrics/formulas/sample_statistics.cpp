// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/formulas/sample_statistics.h"

#include <algorithm>
#include <cmath>

namespace cdiff::metrics {

void SampleStatistics::add(double sample) {
  if (!std::isfinite(sample)) return;
  minimum_ = count_ == 0 ? sample : std::min(minimum_, sample);
  ++count_;
  const double step = sample - mean_;
  mean_ += step / static_cast<double>(count_);
  squares_ += step * (sample - mean_);
}

std::optional<double> SampleStatistics::mean() const {
  return count_ == 0 ? std::nullopt : std::optional<double>(mean_);
}

std::optional<double> SampleStatistics::standardDeviation() const {
  if (count_ < 2) return std::nullopt;
  return std::sqrt(squares_ / static_cast<double>(count_ - 1));
}

DistributionMeasure SampleStatistics::measure(const std::string& reason_when_empty) const {
  Measure empty;
  empty.n = count_;
  empty.reason = reason_when_empty;
  DistributionMeasure measure{empty, empty, empty};
  if (count_ == 0) return measure;
  measure.mean.value = mean_;
  measure.mean.reason.clear();
  measure.minimum.value = minimum_;
  measure.minimum.reason.clear();
  if (count_ < 2) {
    measure.standard_deviation.reason = "n = 1, needs at least 2";
    return measure;
  }
  measure.standard_deviation.value = standardDeviation();
  measure.standard_deviation.reason.clear();
  return measure;
}

void TickShare::add(bool held) {
  ++ticks_;
  if (held) ++held_ticks_;
}

Measure TickShare::measure(const std::string& reason_when_empty) const {
  Measure measure;
  measure.n = ticks_;
  if (ticks_ == 0) {
    measure.reason = reason_when_empty;
    return measure;
  }
  measure.value = 100.0 * static_cast<double>(held_ticks_) / static_cast<double>(ticks_);
  return measure;
}

Measure countPerKilometer(std::size_t count, double distance, std::size_t n, const char* reason) {
  if (!(distance > 0.0)) return {std::nullopt, n, {}, reason};
  return {1000.0 * static_cast<double>(count) / distance, n, {}, {}};
}

Measure collisionsPerKilometer(std::size_t collisions, double distance, std::size_t vehicles) {
  return countPerKilometer(collisions, distance, vehicles, vehicles == 0 ? kNoCbv : "no CBV moved");
}

}  // namespace cdiff::metrics
