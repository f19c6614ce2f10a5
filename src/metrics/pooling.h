// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "e2e_cdiff/metrics/metric.h"

namespace cdiff::metrics {

/// The rule of a measure with nothing left to its unit, subject and kind. Shares lie between 0 and
/// 100, counts and rates at 0 or above.
PoolingRule poolingOf(const MeasureDefinition& definition);

/// "mean", "statistic", "count", "rate" or "share".
const char* toText(Pooling kind);

/// For people: "share of samples, 0 to 100", "count, per km of the ego".
std::string poolingText(const MeasureDefinition& definition);

}  // namespace cdiff::metrics
