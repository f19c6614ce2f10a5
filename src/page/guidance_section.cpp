// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/guidance_section.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/text.h"
#include "page/page_parts.h"
#include "page/pictures/charts.h"
#include "page/pictures/top_view.h"
#include "page/report_tables.h"

namespace cdiff::page {
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
    if (pause || index % stride == 0) line.points.emplace_back(sample.time, sample.value);
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

Markup objectiveChart(const record::SessionResult& result, const record::GuidanceSeries& series,
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

Markup guidanceLegend(const record::SessionResult& result,
                      const std::vector<std::string>& vehicles) {
  Markup items;
  for (const std::string& id : vehicles) {
    items +=
        legendLine("series " + styleOf(traffic::VehicleRole::kCbv, id, result.cbv), "CBV " + id);
  }
  return pageLegend(items);
}

}  // namespace

Markup guidanceSection(const record::SessionResult& result) {
  const record::GuidanceLog& log = result.guidance;
  if (log.series().empty()) return pageNote("No plan of a CBV was guided.");
  const std::vector<std::string> vehicles = vehiclesOf(log);
  Markup charts = "\n";
  for (const record::GuidanceSeries& series : log.series()) {
    charts += objectiveChart(result, series, vehicles);
  }
  Markup html = guidanceLegend(result, vehicles) + element("div", {{"class", "charts"}}, charts) +
                "\n" + guidanceTable(log);
  if (log.challenge().decisions > 0) html += challengeTable(log.challenge());
  const auto share = log.trustRegion().mean;
  if (!share) return html;
  return html + pageNote("The trust region limited " + core::formatFixed(100.0 * *share, 1) +
                         " % of the guided denoising steps.");
}

}  // namespace cdiff::page
