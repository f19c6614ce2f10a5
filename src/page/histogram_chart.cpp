// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/histogram_chart.h"

#include <algorithm>

#include "core/markup.h"
#include "page/chart_axes.h"

namespace cdiff::page {
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
  std::string data =
      "M" +
      core::shortNumber(axes.x(sample.low() + static_cast<double>(bins.first) * sample.width())) +
      " " + core::shortNumber(axes.y(0.0));
  for (std::size_t bin = bins.first; bin < bins.second; ++bin) {
    const double right = sample.low() + static_cast<double>(bin + 1) * sample.width();
    data += "V" + core::shortNumber(axes.y(100.0 * sample.share(bin))) + "H" +
            core::shortNumber(axes.x(right));
  }
  return data + "V" + core::shortNumber(axes.y(0.0)) + "Z";
}

}  // namespace

std::string histogramSvg(const HistogramChart& chart, const std::string& caption) {
  const auto bins = filledBins(chart);
  const record::Histogram& shape = *chart.samples.front().second;
  const ChartAxes axes(shape.low() + static_cast<double>(bins.first) * shape.width(),
                       shape.low() + static_cast<double>(bins.second) * shape.width(), 0.0,
                       largestPercent(chart));
  const std::string title = core::escapeMarkup(chart.title);
  std::string svg = "<figure class=\"chart own\"><figcaption>" + title +
                    " [% of each sample]</figcaption>\n<svg role=\"img\" aria-label=\"" + title +
                    ": " + core::escapeMarkup(caption) + "\" viewBox=\"0 0 " +
                    core::shortNumber(kChartWidth) + " " + core::shortNumber(kChartHeight) +
                    "\">\n" + axes.grid(chart.unit);
  for (const auto& [style, sample] : chart.samples) {
    if (sample->n() == 0) continue;
    svg += "<path class=\"bars " + style + "\" d=\"" + bars(*sample, bins, axes) + "\"/>\n";
  }
  return svg + "</svg><p class=\"note\">" + core::escapeMarkup(caption) + "</p></figure>\n";
}

}  // namespace cdiff::page
