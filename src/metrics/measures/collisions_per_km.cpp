// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/measures/collisions_per_km.h"

#include "metrics/measures/sample_statistics.h"

namespace cdiff::metrics {

Measure countPerKilometre(std::size_t count, double distance, std::size_t n, const char* reason) {
  if (!(distance > 0.0)) return {std::nullopt, n, {}, reason};
  return {1000.0 * static_cast<double>(count) / distance, n, {}, {}};
}

Measure collisionsPerKilometre(std::size_t collisions, double distance, std::size_t vehicles) {
  return countPerKilometre(collisions, distance, vehicles, vehicles == 0 ? kNoCbv : "no CBV moved");
}

}  // namespace cdiff::metrics
