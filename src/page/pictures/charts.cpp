// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/pictures/charts.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"

namespace cdiff::page {
namespace {

constexpr double kRounding = 1e-9;   // [steps of an axis]
constexpr double kHalfLetter = 4.0;  // half the width of a letter [px]

}  // namespace

double niceStep(double span, int count) {
  const double rough = span / count;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough * (1.0 - kRounding)) return factor * power;
  }
  return 10.0 * power;
}

std::string axisNumber(double value, double step) {
  // Steps such as 0.1 add up to numbers such as 0.30000000000000004.
  const double resolution = std::pow(10.0, 3.0 - std::floor(std::log10(step)));
  const double rounded = std::round(value * resolution) / resolution + 0.0;
  if (std::abs(rounded) >= 1e6) return core::formatNumber(rounded / 1e6) + "M";
  if (std::abs(rounded) >= 1e4) return core::formatNumber(rounded / 1e3) + "k";
  return core::formatNumber(rounded);
}

core::Markup chartText(const std::string& style, double x, double y, const std::string& content) {
  return core::element("text", {{"class", style}, {"x", x}, {"y", y}},
                       core::cutText(content, kMostLineLetters));
}

core::Markup svgPath(const std::string& style, const std::string& data, const std::string& title) {
  if (data.empty()) return {};
  const core::Markup tip = title.empty() ? core::Markup() : core::element("title", {}, title);
  return core::element("path", {{"class", style}, {"d", data}}, tip) + "\n";
}

core::Markup svgCircle(const std::string& style, const Eigen::Vector2d& center, double radius,
                       const core::Markup& content) {
  return core::element(
      "circle", {{"class", style}, {"cx", center.x()}, {"cy", center.y()}, {"r", radius}}, content);
}

std::string svgPlace(double x, double y) {
  return core::shortNumber(x) + " " + core::shortNumber(y);
}

core::Markup svgPicture(const std::string& title, const Eigen::Vector2d& size,
                        const std::vector<core::Attribute>& attributes,
                        const core::Markup& content) {
  std::vector<core::Attribute> all = {
      {"role", "img"}, {"aria-label", title}, {"viewBox", "0 0 " + svgPlace(size.x(), size.y())}};
  all.insert(all.end(), attributes.begin(), attributes.end());
  return core::element("svg", all, "\n" + content);
}

core::Markup chartFigure(const std::string& style, const std::string& caption,
                         const core::Markup& content) {
  const core::Markup text = core::element("figcaption", {}, caption);
  return core::element("figure", {{"class", style}}, text + "\n" + content) + "\n";
}

ChartAxes::ChartAxes(double left, double right, double bottom, double top)
    : left_(left), right_(right), low_(bottom), step_(niceStep(top - bottom, 5)) {
  high_ = low_ + step_ * std::ceil((top - low_) / step_ - kRounding);
}

double ChartAxes::x(double quantity) const {
  const double share = (quantity - left_) / (right_ - left_);
  return kChartLeft + (kChartWidth - kChartLeft - kChartRight) * share;
}

double ChartAxes::y(double value) const {
  const double share = std::clamp((value - low_) / (high_ - low_), 0.0, 1.0);
  return kChartHeight - kChartBottom - (kChartHeight - kChartTop - kChartBottom) * share;
}

core::Markup ChartAxes::valueGrid() const {
  core::Markup svg;
  const int rows = static_cast<int>(std::lround((high_ - low_) / step_));
  for (int i = 0; i <= rows; ++i) {
    const double value = low_ + i * step_;
    svg += core::element("path", {{"class", "grid"},
                                  {"d", "M" + svgPlace(kChartLeft, y(value)) + "H" +
                                            core::shortNumber(kChartWidth - kChartRight)}}) +
           chartText("tick end", kChartLeft - 6.0, y(value) + 4.0, axisNumber(value, step_));
  }
  return svg;
}

core::Markup ChartAxes::grid(const std::string& unit) const {
  core::Markup svg = valueGrid();
  const double step = niceStep(right_ - left_, 8);
  const double first = std::ceil(left_ / step - kRounding);
  const double last = std::floor(right_ / step + kRounding);
  for (double i = first; i <= last; i += 1.0) {
    const std::string text = axisNumber(i * step, step) + (i == last ? " " + unit : "");
    // With its unit the last number may reach beyond the picture.
    const bool at_edge = x(i * step) + kHalfLetter * static_cast<double>(text.size()) > kChartWidth;
    svg += at_edge ? chartText("tick end", kChartWidth - 1.0, kChartHeight - 7.0, text)
                   : chartText("tick middle", x(i * step), kChartHeight - 7.0, text);
  }
  return svg + "\n";
}

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

/// Points with a value are joined; one without neighbors is a dot.
core::Markup seriesPath(const ChartSeries& series, const ChartAxes& axes) {
  std::string lines;
  std::string dots;
  const auto& points = series.points;
  const auto drawn = [&](std::size_t i) {
    return i < points.size() && std::isfinite(points[i].second);
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!drawn(i)) continue;
    const bool joins = i > 0 && drawn(i - 1);
    const std::string place = svgPlace(axes.x(points[i].first), axes.y(points[i].second));
    if (joins || drawn(i + 1)) {
      lines += (joins ? "L" : "M") + place;
    } else {
      dots += "M" + place + "h0.01";
    }
  }
  return svgPath("series " + series.style, lines) + svgPath("series dot " + series.style, dots);
}

core::Markup markSvg(const ChartMark& mark, const ChartAxes& axes) {
  const double x = axes.x(mark.time);
  const double y = axes.y(mark.value);
  const bool right_half = x > 0.5 * kChartWidth;
  const double text_y = y > kChartTop + 24.0 ? y - 9.0 : y + 18.0;
  return svgCircle("mark", {x, y}, 4.0) +
         chartText(right_half ? "mark-text end" : "mark-text", x, text_y, mark.text) + "\n";
}

const Eigen::Vector2d kChartSize(kChartWidth, kChartHeight);

}  // namespace

core::Markup timeChart(const std::string& heading, double duration, bool own_time,
                       const core::Markup& content) {
  const std::vector<core::Attribute> attributes = {{"data-left", kChartLeft},
                                                   {"data-right", kChartWidth - kChartRight},
                                                   {"data-duration", core::formatNumber(duration)}};
  const std::string line =
      "M0 " + core::shortNumber(kChartTop) + "V" + core::shortNumber(kChartHeight - kChartBottom);
  const core::Markup cursor =
      own_time ? core::Markup() : core::element("path", {{"class", "cursor"}, {"d", line}});
  return chartFigure(own_time ? "chart own" : "chart", heading,
                     svgPicture(heading + " over time", kChartSize, attributes, content + cursor));
}

core::Markup chartSvg(const Chart& chart) {
  const ChartAxes axes = axesOf(chart);
  core::Markup svg = axes.grid("s");
  // The first series lies on top.
  for (auto series = chart.series.rbegin(); series != chart.series.rend(); ++series) {
    svg += seriesPath(*series, axes);
  }
  for (const ChartMark& mark : chart.marks) svg += markSvg(mark, axes);
  const std::string unit = chart.unit.empty() ? "" : " [" + chart.unit + "]";
  return timeChart(chart.title + unit, durationOf(chart), chart.own_time, svg);
}

namespace {

/// First bin with anything in it and the one after the last, over all samples.
std::pair<std::size_t, std::size_t> filledBins(const HistogramChart& chart) {
  const std::size_t bins = chart.samples.front().second->counts().size();
  std::size_t first = bins;
  std::size_t end = 0;
  for (const auto& [style, sample] : chart.samples) {
    for (std::size_t bin = 0; bin < bins; ++bin) {
      if (sample->counts()[bin] == 0) continue;
      first = std::min(first, bin);
      end = std::max(end, bin + 1);
    }
  }
  return end == 0 ? std::make_pair(std::size_t{0}, bins) : std::make_pair(first, end);
}

double largestPercent(const HistogramChart& chart) {
  double largest = 5.0;
  for (const auto& [style, sample] : chart.samples) {
    for (std::size_t bin = 0; bin < sample->counts().size(); ++bin) {
      largest = std::max(largest, 100.0 * sample->share(bin));
    }
  }
  return largest;
}

std::string bars(const record::Histogram& sample, std::pair<std::size_t, std::size_t> bins,
                 const ChartAxes& axes) {
  const double left = sample.low() + static_cast<double>(bins.first) * sample.width();
  std::string data = "M" + svgPlace(axes.x(left), axes.y(0.0));
  for (std::size_t bin = bins.first; bin < bins.second; ++bin) {
    const double right = sample.low() + static_cast<double>(bin + 1) * sample.width();
    data += "V" + core::shortNumber(axes.y(100.0 * sample.share(bin))) + "H" +
            core::shortNumber(axes.x(right));
  }
  return data + "V" + core::shortNumber(axes.y(0.0)) + "Z";
}

}  // namespace

core::Markup histogramSvg(const HistogramChart& chart, const std::string& caption) {
  const auto bins = filledBins(chart);
  const record::Histogram& shape = *chart.samples.front().second;
  const ChartAxes axes(shape.low() + static_cast<double>(bins.first) * shape.width(),
                       shape.low() + static_cast<double>(bins.second) * shape.width(), 0.0,
                       largestPercent(chart));
  core::Markup svg = axes.grid(chart.unit);
  for (const auto& [style, sample] : chart.samples) {
    if (sample->n() > 0) svg += svgPath("bars " + style, bars(*sample, bins, axes));
  }
  return chartFigure("chart own", chart.title + " [% of each sample]",
                     svgPicture(chart.title + ": " + caption, kChartSize, {}, svg) +
                         core::element("p", {{"class", "note"}}, caption));
}

}  // namespace cdiff::page
