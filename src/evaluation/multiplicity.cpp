// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/comparison.h"

namespace cdiff::evaluation {

void adjustForNumber(std::vector<Comparison>& comparisons) {
  std::vector<double> p;
  for (const Comparison& comparison : comparisons) {
    for (const MeasureComparison& measure : comparison.measures) p.push_back(measure.p);
  }
  auto adjusted = holmAdjusted(p);
  auto next = adjusted.begin();
  for (Comparison& comparison : comparisons) {
    for (MeasureComparison& measure : comparison.measures) measure.p_holm = *next++;
  }
}

Multiplicity multiplicityOf(const std::vector<Comparison>& comparisons) {
  constexpr double kLargest = 0.05;
  Multiplicity result;
  for (const Comparison& comparison : comparisons) {
    for (const MeasureComparison& measure : comparison.measures) {
      ++result.differences;
      result.apart += measure.p <= kLargest;
      result.apart_by_holm += measure.p_holm <= kLargest;
    }
  }
  return result;
}

}  // namespace cdiff::evaluation
