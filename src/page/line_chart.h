// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A line chart over time as one SVG element: the session's time, which the page's slider marks and
/// a click chooses, or a time of its own.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace cdiff::page {

struct ChartSeries {
  std::string style;  ///< CSS class of the line
  /// (time [s], value) in order of time; a value that is not finite breaks the line.
  std::vector<std::pair<double, double>> points;
};

/// A point worth naming.
struct ChartMark {
  double time = 0.0;  ///< [s]
  double value = 0.0;
  std::string text;
};

struct Chart {
  std::string title;
  std::string unit;
  double duration = 0.0;   ///< right end of the time axis [s]
  double least_top = 1.0;  ///< the value axis reaches at least this
  double bottom = 0.0;     ///< lower end of the value axis
  std::vector<ChartSeries> series = {};
  std::vector<ChartMark> marks = {};
  bool own_time = false;  ///< its times are not the session's
};

std::string chartSvg(const Chart& chart);

}  // namespace cdiff::page
