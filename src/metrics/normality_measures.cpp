// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/normality_measures.h"

#include "metrics/shapiro_wilk.h"

namespace cdiff::metrics {
namespace {

/// Every k-th sample, k the smallest that leaves no more than the test allows.
std::vector<double> thinned(const std::vector<double>& samples, std::size_t& every) {
  every = (samples.size() + kShapiroWilkMost - 1) / kShapiroWilkMost;
  if (every <= 1) return samples;
  std::vector<double> kept;
  for (std::size_t i = 0; i < samples.size(); i += every) kept.push_back(samples[i]);
  return kept;
}

}  // namespace

NormalityMeasures normalityMeasures(const std::vector<double>& samples,
                                    const char* reason_when_empty) {
  NormalityMeasures measures;
  if (samples.empty()) {
    measures.w.reason = measures.p.reason = reason_when_empty;
    return measures;
  }
  std::size_t every = 1;
  const std::vector<double> used = thinned(samples, every);
  const ShapiroWilk test = shapiroWilk(used);
  Measure common;
  common.n = used.size();
  common.reason = test.reason;
  if (test.w && every > 1) {
    common.reason = "1 in " + std::to_string(every) + " of " + std::to_string(samples.size()) +
                    " samples taken";
  }
  measures.w = measures.p = common;
  measures.w.value = test.w;
  measures.p.value = test.p;
  return measures;
}

}  // namespace cdiff::metrics
