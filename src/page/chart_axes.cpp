// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/chart_axes.h"

#include <algorithm>
#include <cmath>

#include "core/markup.h"
#include "core/text.h"

namespace cdiff::page {
namespace {

constexpr double kRounding = 1e-9;   // share of a step
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

std::string chartText(const std::string& style, double x, double y, const std::string& content) {
  return "<text class=\"" + style + "\" x=\"" + core::shortNumber(x) + "\" y=\"" +
         core::shortNumber(y) + "\">" + core::escapeMarkup(content) + "</text>";
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

std::string ChartAxes::grid(const std::string& unit) const {
  std::string svg;
  const int rows = static_cast<int>(std::lround((high_ - low_) / step_));
  for (int i = 0; i <= rows; ++i) {
    const double value = low_ + i * step_;
    svg += "<path class=\"grid\" d=\"M" + core::shortNumber(kChartLeft) + " " +
           core::shortNumber(y(value)) + "H" + core::shortNumber(kChartWidth - kChartRight) +
           "\"/>" +
           chartText("tick end", kChartLeft - 6.0, y(value) + 4.0, axisNumber(value, step_));
  }
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

}  // namespace cdiff::page
