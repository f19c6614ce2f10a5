// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/report/line_chart.h"

#include <algorithm>
#include <cmath>

#include "e2e_cdiff/core/text.h"
#include "e2e_cdiff/report/markup.h"

namespace cdiff::report {
namespace {

// Sizes in pixels.
constexpr double kWidth = 540.0;
constexpr double kHeight = 190.0;
constexpr double kLeft = 42.0;
constexpr double kRight = 12.0;
constexpr double kTop = 12.0;
constexpr double kBottom = 24.0;

/// From time and value to pixels.
class Axes {
 public:
  explicit Axes(const Chart& chart)
      : duration_(chart.duration > 0.0 ? chart.duration : 1.0), low_(chart.bottom) {
    double top = chart.least_top;
    for (const ChartSeries& series : chart.series) {
      for (const auto& point : series.points) {
        if (std::isfinite(point.second)) top = std::max(top, point.second);
      }
    }
    step_ = niceStep(top - low_, 5);
    high_ = low_ + step_ * std::ceil((top - low_) / step_ - 1e-9);
  }

  double x(double time) const { return kLeft + (kWidth - kLeft - kRight) * time / duration_; }
  double y(double value) const {
    const double share = std::clamp((value - low_) / (high_ - low_), 0.0, 1.0);
    return kHeight - kBottom - (kHeight - kTop - kBottom) * share;
  }
  double duration() const { return duration_; }
  double low() const { return low_; }
  double high() const { return high_; }
  double step() const { return step_; }

 private:
  double duration_;
  double low_;
  double high_ = 1.0;
  double step_ = 1.0;
};

std::string text(const std::string& style, double x, double y, const std::string& content) {
  return "<text class=\"" + style + "\" x=\"" + shortNumber(x) + "\" y=\"" + shortNumber(y) +
         "\">" + escapeMarkup(content) + "</text>";
}

/// A multiple of `step` in few letters: "0.3", "80k". Steps such as 0.1 add up to numbers such as
/// 0.30000000000000004.
std::string axisNumber(double value, double step) {
  const double resolution = std::pow(10.0, 3.0 - std::floor(std::log10(step)));
  const double rounded = std::round(value * resolution) / resolution + 0.0;
  if (std::abs(rounded) >= 1e6) return core::formatNumber(rounded / 1e6) + "M";
  if (std::abs(rounded) >= 1e4) return core::formatNumber(rounded / 1e3) + "k";
  return core::formatNumber(rounded);
}

std::string grid(const Axes& axes) {
  std::string svg;
  const int rows = static_cast<int>(std::lround((axes.high() - axes.low()) / axes.step()));
  for (int i = 0; i <= rows; ++i) {
    const double value = axes.low() + i * axes.step();
    svg += "<path class=\"grid\" d=\"M" + shortNumber(kLeft) + " " + shortNumber(axes.y(value)) +
           "H" + shortNumber(kWidth - kRight) + "\"/>" +
           text("tick end", kLeft - 6.0, axes.y(value) + 4.0, axisNumber(value, axes.step()));
  }
  const double step = niceStep(axes.duration(), 8);
  const int columns = static_cast<int>(axes.duration() / step + 1e-9);
  for (int i = 0; i <= columns; ++i) {
    svg += text("tick middle", axes.x(i * step), kHeight - 7.0,
                axisNumber(i * step, step) + (i == columns ? " s" : ""));
  }
  return svg + "\n";
}

std::string seriesPath(const ChartSeries& series, const Axes& axes) {
  std::string data;
  bool open = false;
  for (const auto& [time, value] : series.points) {
    if (std::isfinite(value)) {
      data += (open ? "L" : "M") + shortNumber(axes.x(time)) + " " + shortNumber(axes.y(value));
    }
    open = std::isfinite(value);
  }
  return data.empty() ? data : "<path class=\"series " + series.style + "\" d=\"" + data + "\"/>\n";
}

std::string markSvg(const ChartMark& mark, const Axes& axes) {
  const double x = axes.x(mark.time);
  const double y = axes.y(mark.value);
  const bool right_half = x > 0.5 * kWidth;
  const double text_y = y > kTop + 24.0 ? y - 9.0 : y + 18.0;
  return "<circle class=\"mark\" cx=\"" + shortNumber(x) + "\" cy=\"" + shortNumber(y) +
         "\" r=\"4\"/>" + text(right_half ? "mark-text end" : "mark-text", x, text_y, mark.text) +
         "\n";
}

}  // namespace

double niceStep(double span, int count) {
  const double rough = span / count;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough * (1.0 - 1e-9)) return factor * power;
  }
  return 10.0 * power;
}

std::string chartSvg(const Chart& chart) {
  const Axes axes(chart);
  const std::string heading =
      escapeMarkup(chart.title) + (chart.unit.empty() ? "" : " [" + escapeMarkup(chart.unit) + "]");
  std::string svg = std::string("<figure class=\"") + (chart.own_time ? "chart own" : "chart") +
                    "\"><figcaption>" + heading + "</figcaption>\n<svg role=\"img\" aria-label=\"" +
                    heading + " over time\" viewBox=\"0 0 " + shortNumber(kWidth) + " " +
                    shortNumber(kHeight) + "\" data-left=\"" + shortNumber(kLeft) +
                    "\" data-right=\"" + shortNumber(kWidth - kRight) + "\" data-duration=\"" +
                    core::formatNumber(axes.duration()) + "\">\n" + grid(axes);
  // The first series lies on top.
  for (auto series = chart.series.rbegin(); series != chart.series.rend(); ++series) {
    svg += seriesPath(*series, axes);
  }
  for (const ChartMark& mark : chart.marks) svg += markSvg(mark, axes);
  if (chart.own_time) return svg + "</svg></figure>\n";
  return svg + "<path class=\"cursor\" d=\"M0 " + shortNumber(kTop) + "V" +
         shortNumber(kHeight - kBottom) + "\"/></svg></figure>\n";
}

}  // namespace cdiff::report
