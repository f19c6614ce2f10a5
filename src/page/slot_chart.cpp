// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/slot_chart.h"

#include <algorithm>

#include "core/markup.h"
#include "core/text.h"
#include "page/chart_axes.h"
#include "page/top_view.h"
#include "record/reason_text.h"

namespace cdiff::page {
namespace {

/// The time axis, and a row of the value axis per slot, slot 0 on top.
struct Rows {
  ChartAxes axes;
  double count;
  double y(int slot) const { return axes.y(count - 0.5 - static_cast<double>(slot)); }
};

Rows rowsOf(const record::SessionResult& result) {
  int highest = 0;
  for (const record::CbvRecord& record : result.cbv.records())
    highest = std::max(highest, record.slot);
  const double count = 1.0 + static_cast<double>(highest);
  return {{0.0, std::max(result.timeline.duration(), 1e-3), 0.0, count}, count};
}

double secondsAt(std::uint64_t tick, const record::SessionResult& result) {
  return static_cast<double>(tick) * result.setup.options().simulation_step;
}

std::string bar(std::size_t index, const record::SessionResult& result, const Rows& rows) {
  const record::CbvRecord& record = result.cbv.records()[index];
  const double begin = secondsAt(record.selected_tick, result);
  const double end = record.released_tick ? secondsAt(*record.released_tick, result)
                                          : std::max(begin, result.timeline.duration());
  const double x = rows.axes.x(begin);
  const double width = rows.axes.x(end) - x;
  const std::string name = "C" + std::to_string(index + 1) + " " + record.vehicle_id;
  const std::string style = styleOf(traffic::VehicleRole::kCbv, record.vehicle_id, result.cbv);
  std::string svg = "<path class=\"stay " + style + "\" d=\"M" + core::shortNumber(x) + " " +
                    core::shortNumber(rows.y(record.slot)) + "h" + core::shortNumber(width) +
                    "\"><title>" + core::escapeMarkup(name) + ", " + core::formatFixed(begin, 2) +
                    " to " + core::formatFixed(end, 2) +
                    " s: " + core::escapeMarkup(record::releaseText(record.release_reason)) +
                    "</title></path>";
  const double letters = 7.0 * static_cast<double>(name.size());  // [pixels]
  const double left = std::max(kChartLeft, std::min(x, kChartWidth - kChartRight - letters));
  return svg + chartText("mark-text", left, rows.y(record.slot) - 10.0, name) + "\n";
}

std::string contacts(const record::SessionResult& result, const Rows& rows) {
  std::string svg;
  for (const record::CbvRecord& record : result.cbv.records()) {
    const double begin = secondsAt(record.selected_tick, result);
    const double end = record.released_tick ? secondsAt(*record.released_tick, result)
                                            : result.timeline.duration();
    for (const record::TimelineContact& contact : result.timeline.contacts()) {
      const bool own = contact.first == record.vehicle_id || contact.second == record.vehicle_id;
      if (!own || contact.time < begin || contact.time > end) continue;
      svg += "<circle class=\"contact\" cx=\"" + core::shortNumber(rows.axes.x(contact.time)) +
             "\" cy=\"" + core::shortNumber(rows.y(record.slot)) + "\" r=\"7\"/>";
    }
  }
  return svg;
}

std::string frame(const record::SessionResult& result, const Rows& rows) {
  std::string svg;
  for (int slot = 0; slot < static_cast<int>(rows.count); ++slot) {
    svg += chartText("tick end", kChartLeft - 6.0, rows.y(slot) + 4.0, std::to_string(slot));
  }
  const double step = niceStep(std::max(result.timeline.duration(), 1e-3), 8);
  for (double time = 0.0; time <= result.timeline.duration() + 1e-9; time += step) {
    const bool last = time + step > result.timeline.duration() + 1e-9;
    svg += chartText("tick middle", rows.axes.x(time), kChartHeight - 7.0,
                     axisNumber(time, step) + (last ? " s" : ""));
  }
  return svg + "\n";
}

}  // namespace

std::string slotChart(const record::SessionResult& result) {
  const Rows rows = rowsOf(result);
  std::string svg =
      "<figure class=\"chart\"><figcaption>CBV of each slot</figcaption>\n<svg role=\"img\" "
      "aria-label=\"CBV of each slot over time\" viewBox=\"0 0 " +
      core::shortNumber(kChartWidth) + " " + core::shortNumber(kChartHeight) + "\" data-left=\"" +
      core::shortNumber(kChartLeft) + "\" data-right=\"" +
      core::shortNumber(kChartWidth - kChartRight) + "\" data-duration=\"" +
      core::formatNumber(std::max(result.timeline.duration(), 1e-3)) + "\">\n" +
      frame(result, rows);
  for (std::size_t i = 0; i < result.cbv.records().size(); ++i) svg += bar(i, result, rows);
  return svg + contacts(result, rows) + "<path class=\"cursor\" d=\"M0 " +
         core::shortNumber(kChartTop) + "V" + core::shortNumber(kChartHeight - kChartBottom) +
         "\"/></svg></figure>\n";
}

}  // namespace cdiff::page
