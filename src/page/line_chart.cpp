// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/line_chart.h"

#include <algorithm>
#include <cmath>

#include "core/markup.h"
#include "core/text.h"
#include "page/chart_axes.h"

namespace cdiff::page {
namespace {

double durationOf(const Chart& chart) { return chart.duration > 0.0 ? chart.duration : 1.0; }

/// Time to the right, values up to the largest of all series.
ChartAxes axesOf(const Chart& chart) {
  double top = chart.least_top;
  for (const ChartSeries& series : chart.series) {
    for (const auto& point : series.points) {
      if (std::isfinite(point.second)) top = std::max(top, point.second);
    }
  }
  return {0.0, durationOf(chart), chart.bottom, top};
}

std::string pathOf(const std::string& style, const std::string& data) {
  return data.empty() ? data : "<path class=\"series " + style + "\" d=\"" + data + "\"/>\n";
}

/// Points with a value are joined; one without neighbours is a dot.
std::string seriesPath(const ChartSeries& series, const ChartAxes& axes) {
  std::string lines;
  std::string dots;
  const auto& points = series.points;
  const auto drawn = [&](std::size_t i) {
    return i < points.size() && std::isfinite(points[i].second);
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!drawn(i)) continue;
    const bool joins = i > 0 && drawn(i - 1);
    const std::string place = core::shortNumber(axes.x(points[i].first)) + " " +
                              core::shortNumber(axes.y(points[i].second));
    if (joins || drawn(i + 1)) {
      lines += (joins ? "L" : "M") + place;
    } else {
      dots += "M" + place + "h0.01";
    }
  }
  return pathOf(series.style, lines) + pathOf("dot " + series.style, dots);
}

std::string markSvg(const ChartMark& mark, const ChartAxes& axes) {
  const double x = axes.x(mark.time);
  const double y = axes.y(mark.value);
  const bool right_half = x > 0.5 * kChartWidth;
  const double text_y = y > kChartTop + 24.0 ? y - 9.0 : y + 18.0;
  return "<circle class=\"mark\" cx=\"" + core::shortNumber(x) + "\" cy=\"" + core::shortNumber(y) +
         "\" r=\"4\"/>" +
         chartText(right_half ? "mark-text end" : "mark-text", x, text_y, mark.text) + "\n";
}

}  // namespace

std::string chartSvg(const Chart& chart) {
  const ChartAxes axes = axesOf(chart);
  const std::string heading =
      core::escapeMarkup(chart.title) +
      (chart.unit.empty() ? "" : " [" + core::escapeMarkup(chart.unit) + "]");
  std::string svg = std::string("<figure class=\"") + (chart.own_time ? "chart own" : "chart") +
                    "\"><figcaption>" + heading + "</figcaption>\n<svg role=\"img\" aria-label=\"" +
                    heading + " over time\" viewBox=\"0 0 " + core::shortNumber(kChartWidth) + " " +
                    core::shortNumber(kChartHeight) + "\" data-left=\"" +
                    core::shortNumber(kChartLeft) + "\" data-right=\"" +
                    core::shortNumber(kChartWidth - kChartRight) + "\" data-duration=\"" +
                    core::formatNumber(durationOf(chart)) + "\">\n" + axes.grid("s");
  // The first series lies on top.
  for (auto series = chart.series.rbegin(); series != chart.series.rend(); ++series) {
    svg += seriesPath(*series, axes);
  }
  for (const ChartMark& mark : chart.marks) svg += markSvg(mark, axes);
  if (chart.own_time) return svg + "</svg></figure>\n";
  return svg + "<path class=\"cursor\" d=\"M0 " + core::shortNumber(kChartTop) + "V" +
         core::shortNumber(kChartHeight - kChartBottom) + "\"/></svg></figure>\n";
}

}  // namespace cdiff::page
