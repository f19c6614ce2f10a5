// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The plane of a chart in a page: 540 x 190 pixels, values on the left, grid lines at round
/// numbers.
#pragma once

#include <string>

namespace cdiff::page {

/// Sizes of a chart [pixels].
inline constexpr double kChartWidth = 540.0;
inline constexpr double kChartHeight = 190.0;
inline constexpr double kChartLeft = 42.0;
inline constexpr double kChartRight = 12.0;
inline constexpr double kChartTop = 12.0;
inline constexpr double kChartBottom = 24.0;

/// A step of 1, 2 or 5 times a power of ten that cuts `span` (positive) into at most `count` parts.
double niceStep(double span, int count);

/// A multiple of `step` in few letters: "0.3", "80k".
std::string axisNumber(double value, double step);

/// One line of text of a CSS class at a pixel.
std::string chartText(const std::string& style, double x, double y, const std::string& content);

/// From quantities to pixels.
class ChartAxes {
 public:
  /// Horizontally [left, right]; vertically from `bottom` to a round number that is at least `top`.
  /// left < right, bottom < top.
  ChartAxes(double left, double right, double bottom, double top);

  double x(double quantity) const;
  double y(double value) const;  ///< held within the chart
  double low() const { return low_; }
  double high() const { return high_; }
  /// Grid lines and numbers of the values, and numbers along the bottom, the last with `unit`.
  std::string grid(const std::string& unit) const;

 private:
  double left_;
  double right_;
  double low_;
  double high_ = 1.0;
  double step_ = 1.0;
};

}  // namespace cdiff::page
