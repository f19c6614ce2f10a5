// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/sample_figures.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "record/latency_log.h"

namespace cdiff::record {

SampleFigures figuresOf(const std::vector<double>& values) {
  std::vector<double> sorted;
  for (const double value : values) {
    if (std::isfinite(value)) sorted.push_back(value);
  }
  std::sort(sorted.begin(), sorted.end());
  SampleFigures figures;
  figures.n = sorted.size();
  if (sorted.empty()) return figures;
  figures.mean =
      std::accumulate(sorted.begin(), sorted.end(), 0.0) / static_cast<double>(sorted.size());
  figures.percentile_95 = nearestRank(sorted, 95.0);
  figures.maximum = sorted.back();
  return figures;
}

}  // namespace cdiff::record
