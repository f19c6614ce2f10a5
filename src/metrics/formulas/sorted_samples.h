// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <initializer_list>
#include <memory_resource>
#include <vector>

namespace cdiff::metrics {

/// The samples of a session in one unit, in ascending order. What was added since the last look is
/// sorted in, so that no copy of the others is made.
class SortedSamples {
 public:
  explicit SortedSamples(std::pmr::memory_resource* memory) : samples_(memory) {}
  SortedSamples(const std::vector<double>& samples);
  SortedSamples(std::initializer_list<double> samples);

  /// A value that is not finite is left out, and known to `allFinite`.
  void add(double sample);
  bool empty() const { return samples_.empty(); }
  std::size_t size() const { return samples_.size(); }
  bool allFinite() const { return all_finite_; }
  const std::pmr::vector<double>& sorted() const;

 private:
  mutable std::pmr::vector<double> samples_;
  mutable std::size_t sorted_ = 0;  ///< so many first ones are in order
  bool all_finite_ = true;
};

}  // namespace cdiff::metrics
