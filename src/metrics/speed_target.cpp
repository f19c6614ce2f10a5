// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/speed_target.h"

#include "core/text.h"
#include "metrics/cbv_measures.h"
#include "metrics/wasserstein.h"

namespace cdiff::metrics {

SpeedTarget::SpeedTarget(const MetricsOptions& options) : options_(options) {
  if (options.speed_target == "file") samples_ = options.samples();
}

void SpeedTarget::addBackground(double speed) {
  if (options_.speed_target == "background") samples_.push_back(speed);
}

std::string SpeedTarget::name() const {
  if (options_.speed_target == "normal") {
    return "normal distribution of mean " + core::formatNumber(options_.speed_target_mean) +
           " m/s and standard deviation " + core::formatNumber(options_.speed_target_deviation) +
           " m/s";
  }
  const std::string count = " (n = " + std::to_string(samples_.size()) + ")";
  if (options_.speed_target == "file") return "file " + options_.speed_target_file + count;
  return "background vehicles within 150 m of the ego" + count;
}

Measure SpeedTarget::distanceFrom(const std::vector<double>& speeds) const {
  Measure measure;
  measure.unit = "m/s";
  measure.n = speeds.size();
  measure.target = name();
  if (speeds.empty()) {
    measure.reason = kNoCbv;
  } else if (options_.speed_target == "normal") {
    measure.value = wassersteinDistanceToNormal(speeds, options_.speed_target_mean,
                                                options_.speed_target_deviation);
  } else if (samples_.empty()) {
    measure.reason = "no background vehicle within 150 m of the ego";
  } else {
    measure.value = wassersteinDistance(speeds, samples_);
  }
  return measure;
}

}  // namespace cdiff::metrics
