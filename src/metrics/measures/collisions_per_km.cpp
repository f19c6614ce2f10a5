// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/measures/collisions_per_km.h"

#include "metrics/measures/sample_statistics.h"

namespace cdiff::metrics {

Measure collisionsPerKilometre(std::size_t collisions, double distance, std::size_t vehicles) {
  Measure measure;
  measure.n = vehicles;
  if (vehicles == 0) {
    measure.reason = kNoCbv;
  } else if (!(distance > 0.0)) {
    measure.reason = "no CBV moved";
  } else {
    measure.value = 1000.0 * static_cast<double>(collisions) / distance;
  }
  return measure;
}

}  // namespace cdiff::metrics
