// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/metrics/off_road_rate.h"

namespace cdiff::metrics {

void OffRoadRate::add(bool off_road) {
  ++ticks_;
  if (off_road) ++off_road_ticks_;
}

Measure OffRoadRate::measure(const std::string& reason_when_empty) const {
  Measure measure;
  measure.unit = "%";
  measure.n = ticks_;
  if (ticks_ == 0) {
    measure.reason = reason_when_empty;
    return measure;
  }
  measure.value = 100.0 * static_cast<double>(off_road_ticks_) / static_cast<double>(ticks_);
  return measure;
}

}  // namespace cdiff::metrics
