// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/tick_share.h"

namespace cdiff::metrics {

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

}  // namespace cdiff::metrics
