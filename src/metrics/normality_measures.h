// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Shapiro-Wilk W and p of a session's samples (any unit), thinned out evenly where there are more
/// than the test allows.
#pragma once

#include <vector>

#include "e2e_cdiff/metrics/figure.h"

namespace cdiff::metrics {

struct NormalityMeasures {
  Measure w;
  Measure p;
};

/// More than 5000 samples: every k-th in time order, k the smallest that leaves no more; `reason`
/// then says "1 in k of N samples taken" and n counts those taken. Absent with a reason for fewer
/// than three, for equal values, and with `reason_when_empty` for none.
NormalityMeasures normalityMeasures(const std::vector<double>& samples,
                                    const char* reason_when_empty);

}  // namespace cdiff::metrics
