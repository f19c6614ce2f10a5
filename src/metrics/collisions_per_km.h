// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Collisions per kilometre (paper's CPK) [1/km]: 1000 x collisions / metres driven.
#pragma once

#include "e2e_cdiff/metrics/figure.h"

namespace cdiff::metrics {

/// n = `vehicles` that drove. Absent with a reason when there was none, or none moved.
Measure collisionsPerKilometre(std::size_t collisions, double distance, std::size_t vehicles);

}  // namespace cdiff::metrics
