// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/motion_sections.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/markup.h"
#include "core/text.h"
#include "metrics/known_figures.h"
#include "page/pictures/charts.h"
#include "page/pictures/top_view.h"
#include "page/report_tables.h"
#include "record/session_text.h"

namespace cdiff::page {
namespace {

std::string sampleText(const std::string& who, const record::Histogram& sample,
                       const std::string& unit) {
  if (sample.n() == 0) return who + ": none";
  std::string text =
      who + ": mean " + core::formatFixed(std::round(100.0 * *sample.mean()) / 100.0 + 0.0, 2);
  if (const auto deviation = sample.standardDeviation()) {
    text += " ± " + core::formatFixed(*deviation, 2);
  }
  return text + " " + unit + ", n = " + std::to_string(sample.n());
}

std::string chart(const std::string& title, const std::string& unit, const record::Histogram& cbv,
                  const record::Histogram& background) {
  return histogramSvg(
      {title, unit, {{"bg", &background}, {"cbv c0", &cbv}}},
      sampleText("CBV", cbv, unit) + "; " + sampleText("background", background, unit));
}

std::string guidanceLegend() {
  const std::string sign = "<span class=\"item\"><svg viewBox=\"0 0 28 14\" aria-hidden=\"true\">";
  return "<p class=\"guidanceLegend\">\n" + sign +
         "<path class=\"bars cbv c0\" d=\"M3 13V3H25V13\"/></svg>CBVs</span>\n" + sign +
         "<path class=\"bars bg\" d=\"M3 13V3H25V13\"/></svg>background vehicles</span>\n</p>\n";
}

}  // namespace

std::string drivingSection(const record::SessionResult& result) {
  const record::DrivingLog& log = result.driving;
  if (log.cbv().speed.n() + log.background().speed.n() == 0) {
    return "<p class=\"note\">No vehicle but the ego was seen at a decision.</p>\n";
  }
  const metrics::SessionMeasures& measures = result.measures;
  return guidanceLegend() + "<div class=\"charts\">\n" +
         chart("Speed", "m/s", log.cbv().speed, log.background().speed) +
         chart("Acceleration", "m/s²", log.cbv().acceleration, log.background().acceleration) +
         "</div>\n<p class=\"note\">One value per vehicle and decision; ± is the standard "
         "deviation "
         "over them. Shapiro-Wilk W of CBVs: speed " +
         core::escapeMarkup(
             record::measureText(measures.at(metrics::figures::kSpeedShapiroWilk), 3)) +
         ", acceleration " +
         core::escapeMarkup(
             record::measureText(measures.at(metrics::figures::kAccelerationShapiroWilk), 3)) +
         ". Wasserstein distance of CBV speeds to background vehicles within 150 m of the ego: " +
         core::escapeMarkup(
             record::measureText(measures.at(metrics::figures::kSpeedWasserstein), 3)) +
         ".</p>\n";
}

namespace {

constexpr std::size_t kMostGuidancePoints = 1500;  // of a line

std::vector<std::string> vehiclesOf(const record::GuidanceLog& log) {
  std::vector<std::string> ids;
  for (const record::GuidanceSeries& series : log.series()) {
    for (const record::GuidanceSample& sample : series.samples) {
      const bool known = std::find(ids.begin(), ids.end(), sample.vehicle_id) != ids.end();
      if (!known) ids.push_back(sample.vehicle_id);
    }
  }
  return ids;
}

ChartSeries lineOf(const record::GuidanceSeries& series, const std::string& id,
                   const std::string& style, double period) {
  ChartSeries line{style, {}};
  const std::size_t stride = 1 + series.samples.size() / kMostGuidancePoints;
  std::size_t index = 0;
  double last_time = 0.0;
  for (const record::GuidanceSample& sample : series.samples) {
    if (sample.vehicle_id != id) continue;
    const bool pause = index > 0 && sample.time - last_time > 1.5 * period;
    if (pause) line.points.emplace_back(last_time, std::numeric_limits<double>::quiet_NaN());
    if (pause || index % stride == 0) line.points.emplace_back(sample.time, sample.report.value);
    last_time = sample.time;
    ++index;
  }
  return line;
}

/// The chart's lower end is 0 or a round number below every value.
void setScale(Chart& chart) {
  double low = 0.0;
  double high = 0.0;
  for (const ChartSeries& series : chart.series) {
    for (const auto& [time, value] : series.points) {
      if (!std::isfinite(value)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
  if (low == 0.0 && high == 0.0) return;
  const double step = niceStep(high - low, 5);
  chart.bottom = step * std::floor(low / step + 1e-9);
  chart.least_top = std::max(high, chart.bottom + step);
}

std::string objectiveChart(const record::SessionResult& result,
                           const record::GuidanceSeries& series,
                           const std::vector<std::string>& vehicles) {
  Chart chart;
  chart.title = series.objective + ": value of the chosen plan, unweighted";
  chart.duration = result.timeline.duration();
  for (const std::string& id : vehicles) {
    const std::string style = styleOf(traffic::VehicleRole::kCbv, id, result.cbv);
    chart.series.push_back(lineOf(series, id, style, result.setup.options().decision_period));
  }
  setScale(chart);
  return chartSvg(chart);
}

std::string guidanceLegend(const record::SessionResult& result,
                           const std::vector<std::string>& vehicles) {
  std::string html = "<p class=\"guidanceLegend\">\n";
  for (const std::string& id : vehicles) {
    html +=
        "<span class=\"item\"><svg viewBox=\"0 0 28 14\" aria-hidden=\"true\"><path "
        "class=\"series " +
        styleOf(traffic::VehicleRole::kCbv, id, result.cbv) + "\" d=\"M1 7H27\"/></svg>CBV " +
        core::escapeMarkup(id) + "</span>\n";
  }
  return html + "</p>\n";
}

}  // namespace

std::string guidanceSection(const record::SessionResult& result) {
  const record::GuidanceLog& log = result.guidance;
  if (log.series().empty()) return "<p class=\"note\">No plan of a CBV was guided.</p>\n";
  const std::vector<std::string> vehicles = vehiclesOf(log);
  std::string html = guidanceLegend(result, vehicles) + "<div class=\"charts\">\n";
  for (const record::GuidanceSeries& series : log.series()) {
    html += objectiveChart(result, series, vehicles);
  }
  html += "</div>\n" + guidanceTable(log);
  if (const auto share = log.trustRegion().mean) {
    html += "<p class=\"note\">The trust region limited " + core::formatFixed(100.0 * *share, 1) +
            " % of the guided denoising steps.</p>\n";
  }
  return html;
}

}  // namespace cdiff::page
