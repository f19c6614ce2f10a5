// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The metrics that come with the package. Their table is made from the list in
/// src/metrics/CMakeLists.txt: NAME stands for NAME_metric.cpp, which defines the function
/// nameMetric().
#pragma once

#include <vector>

#include "e2e_cdiff/metrics/metric.h"

namespace cdiff::metrics {

std::vector<MetricDescriptor> shippedMetrics();

}  // namespace cdiff::metrics
