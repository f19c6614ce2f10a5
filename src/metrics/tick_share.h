// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Share of ticks of equal length at which something held [%]: 100 x ticks where it did / ticks.
#pragma once

#include <cstddef>
#include <string>

#include "e2e_cdiff/metrics/figure.h"

namespace cdiff::metrics {

class TickShare {
 public:
  void add(bool held);
  std::size_t ticks() const { return ticks_; }
  /// In percent, with n = ticks; without any tick absent with `reason_when_empty`.
  Measure measure(const std::string& reason_when_empty) const;

 private:
  std::size_t ticks_ = 0;
  std::size_t held_ticks_ = 0;
};

}  // namespace cdiff::metrics
