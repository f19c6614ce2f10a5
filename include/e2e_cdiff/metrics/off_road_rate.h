// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Off-road rate (paper's ORR) [%]: 100 x ticks with the centre off the drivable area / ticks.
#pragma once

#include <cstddef>
#include <string>

#include "e2e_cdiff/metrics/session_measures.h"

namespace cdiff::metrics {

/// Counts ticks of equal length.
class OffRoadRate {
 public:
  void add(bool off_road);
  std::size_t ticks() const { return ticks_; }
  /// In percent with n = ticks; without any tick absent with `reason_when_empty`.
  Measure measure(const std::string& reason_when_empty) const;

 private:
  std::size_t ticks_ = 0;
  std::size_t off_road_ticks_ = 0;
};

}  // namespace cdiff::metrics
