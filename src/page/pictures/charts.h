// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "core/markup.h"
#include "record/logs/driving_log.h"

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

// Elements of pictures (pixels, x right, y down). `style` is a CSS class, or several.

/// Most characters of a line of text in a picture.
inline constexpr std::size_t kMostLineLetters = 160;

/// One line of text; what is longer than kMostLineLetters is cut.
core::Markup chartText(const std::string& style, double x, double y, const std::string& content);

/// A path of `data` (attribute d) with a tool tip; nothing without data.
core::Markup svgPath(const std::string& style, const std::string& data,
                     const std::string& title = {});

core::Markup svgCircle(const std::string& style, const Eigen::Vector2d& center, double radius,
                       const core::Markup& content = {});

/// "x y", one decimal each, for path data.
std::string svgPlace(double x, double y);

/// An <svg> of `size` (width, height) with further attributes; `title` is read aloud.
core::Markup svgPicture(const std::string& title, const Eigen::Vector2d& size,
                        const std::vector<core::Attribute>& attributes,
                        const core::Markup& content);

/// A <figure> with a caption above its content.
core::Markup chartFigure(const std::string& style, const std::string& caption,
                         const core::Markup& content);

/// From quantities to pixels of a chart in a page: 540 x 190 pixels, values on the left, grid lines
/// at round numbers.
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
  core::Markup grid(const std::string& unit) const;
  /// Those of the values alone.
  core::Markup valueGrid() const;

 private:
  double left_;
  double right_;
  double low_;
  double high_ = 1.0;
  double step_ = 1.0;
};

// A line chart over time as one SVG element: the session's time, which the page's slider marks and
// a click chooses, or a time of its own.

/// A line of a chart: values over time [s].
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

/// A chart of values over time [s]: title, unit, axes, lines and marks.
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

core::Markup chartSvg(const Chart& chart);

/// The figure around a chart over `duration` [s]; the page's slider marks the time in it unless it
/// has a time of its own.
core::Markup timeChart(const std::string& heading, double duration, bool own_time,
                       const core::Markup& content);

/// Histograms with the same bins laid over each other, as one SVG element: share of each sample
/// [%] per bin.
struct HistogramChart {
  std::string title;
  std::string unit;
  /// (CSS class, sample), the last on top; all with the same bins.
  std::vector<std::pair<std::string, const record::Histogram*>> samples;
};

/// The range of values is that of the bins with anything in them. `caption` is plain text below.
core::Markup histogramSvg(const HistogramChart& chart, const std::string& caption);

}  // namespace cdiff::page
