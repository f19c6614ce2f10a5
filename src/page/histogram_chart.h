// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Histograms with the same bins laid over each other, as one SVG element: share of each sample
/// [%] per bin.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "record/histogram.h"

namespace cdiff::page {

struct HistogramChart {
  std::string title;
  std::string unit;
  /// (CSS class, sample), the last on top; all with the same bins.
  std::vector<std::pair<std::string, const record::Histogram*>> samples;
};

/// The range of values is that of the bins with anything in them. `caption` is plain text below.
std::string histogramSvg(const HistogramChart& chart, const std::string& caption);

}  // namespace cdiff::page
