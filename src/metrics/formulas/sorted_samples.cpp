// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/formulas/sorted_samples.h"

#include <algorithm>
#include <boost/sort/pdqsort/pdqsort.hpp>
#include <cmath>

namespace cdiff::metrics {

SortedSamples::SortedSamples(const std::vector<double>& samples) {
  samples_.reserve(samples.size());
  for (const double sample : samples) add(sample);
}

SortedSamples::SortedSamples(std::initializer_list<double> samples)
    : SortedSamples(std::vector<double>(samples)) {}

void SortedSamples::add(double sample) {
  if (std::isfinite(sample)) {
    samples_.push_back(sample);
  } else {
    all_finite_ = false;
  }
}

const std::pmr::vector<double>& SortedSamples::sorted() const {
  const auto middle = samples_.begin() + static_cast<std::ptrdiff_t>(sorted_);
  boost::sort::pdqsort_branchless(middle, samples_.end());
  std::inplace_merge(samples_.begin(), middle, samples_.end());
  sorted_ = samples_.size();
  return samples_;
}

}  // namespace cdiff::metrics
