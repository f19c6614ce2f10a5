// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/pictures/session_charts.h"

#include <algorithm>
#include <functional>
#include <limits>

#include "core/text.h"
#include "page/page_parts.h"
#include "page/pictures/charts.h"
#include "page/pictures/top_view.h"
#include "record/session_text.h"

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

double endOf(const record::CbvRecord& record, const record::SessionResult& result) {
  return record.released_tick ? secondsAt(*record.released_tick, result)
                              : result.timeline.duration();
}

Markup bar(std::size_t index, const record::SessionResult& result, const Rows& rows) {
  const record::CbvRecord& record = result.cbv.records()[index];
  const double begin = secondsAt(record.selected_tick, result);
  const double end =
      record.released_tick ? endOf(record, result) : std::max(begin, endOf(record, result));
  const double x = rows.axes.x(begin);
  const std::string& name = record.vehicle_id;
  const std::string tip = name + ", " + core::formatFixed(begin, 2) + " to " +
                          core::formatFixed(end, 2) +
                          " s: " + record::releaseText(record.release_reason);
  const Markup stay = element(
      "path",
      {{"class", "stay " + styleOf(traffic::VehicleRole::kCbv, record.vehicle_id, result.cbv)},
       {"d",
        "M" + svgPlace(x, rows.y(record.slot)) + "h" + core::shortNumber(rows.axes.x(end) - x)}},
      element("title", {}, tip));
  const double letters = 7.0 * static_cast<double>(name.size());  // [pixels]
  const double left = std::max(kChartLeft, std::min(x, kChartWidth - kChartRight - letters));
  return stay + chartText("mark-text", left, rows.y(record.slot) - 10.0, name) + "\n";
}

Markup contacts(const record::SessionResult& result, const Rows& rows) {
  Markup svg;
  for (const record::CbvRecord& record : result.cbv.records()) {
    const double begin = secondsAt(record.selected_tick, result);
    for (const record::TimelineContact& contact : result.timeline.contacts()) {
      const bool own = contact.first == record.vehicle_id || contact.second == record.vehicle_id;
      if (!own || contact.time < begin || contact.time > endOf(record, result)) continue;
      svg += svgCircle("contact", {rows.axes.x(contact.time), rows.y(record.slot)}, 7.0);
    }
  }
  return svg;
}

Markup frame(const record::SessionResult& result, const Rows& rows) {
  Markup svg;
  const double step = niceStep(std::max(result.timeline.duration(), 1e-3), 8);
  for (double time = 0.0; time <= result.timeline.duration() + 1e-9; time += step) {
    const bool last = time + step > result.timeline.duration() + 1e-9;
    svg += chartText("tick middle", rows.axes.x(time), kChartHeight - 7.0,
                     axisNumber(time, step) + (last ? " s" : ""));
  }
  return svg + "\n";
}

}  // namespace

Markup slotChart(const record::SessionResult& result) {
  const Rows rows = rowsOf(result);
  Markup svg = frame(result, rows);
  for (std::size_t i = 0; i < result.cbv.records().size(); ++i) svg += bar(i, result, rows);
  return timeChart("Who was CBV", std::max(result.timeline.duration(), 1e-3), false,
                   svg + contacts(result, rows));
}

namespace {

using traffic::VehicleRole;

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kMostPoints = 1500;  // of a line
constexpr double kLongestTime = 10.0;      // to a collision that is worth a look [s]

/// What a chart shows of a pose; not a number where there is nothing.
using Quantity = std::function<double(const record::TimelinePose&)>;

/// The ego (where it was), then every CBV in order of selection.
struct Subject {
  std::string id;
  VehicleRole role = VehicleRole::kCbv;
};

std::vector<Subject> subjectsOf(const record::SessionResult& result) {
  std::vector<Subject> subjects;
  for (const record::TimelineFrame& frame : result.timeline.frames()) {
    const bool ego = !frame.poses.empty() && frame.poses.front().role == VehicleRole::kEgo;
    if (!ego) continue;
    subjects.push_back(
        {result.timeline.vehicles()[frame.poses.front().vehicle].id, VehicleRole::kEgo});
    break;
  }
  for (const record::CbvRecord& record : result.cbv.records()) {
    const bool known = std::any_of(subjects.begin(), subjects.end(), [&](const Subject& subject) {
      return subject.id == record.vehicle_id;
    });
    if (!known) subjects.push_back({record.vehicle_id, VehicleRole::kCbv});
  }
  return subjects;
}

ChartSeries seriesOf(const record::SessionResult& result, const Subject& subject,
                     const Quantity& quantity) {
  const record::Timeline& timeline = result.timeline;
  ChartSeries series{styleOf(subject.role, subject.id, result.cbv), {}};
  const std::size_t stride = 1 + timeline.frames().size() / kMostPoints;
  for (std::size_t i = 0; i < timeline.frames().size(); i += stride) {
    const record::TimelineFrame& frame = timeline.frames()[i];
    double value = kNothing;
    for (const record::TimelinePose& pose : frame.poses) {
      if (pose.role == VehicleRole::kBackground) break;  // ego first, then CBVs
      const bool same =
          pose.role == subject.role && timeline.vehicles()[pose.vehicle].id == subject.id;
      if (same) value = quantity(pose);
    }
    series.points.emplace_back(frame.time, value);
  }
  return series;
}

Chart chartOf(const record::SessionResult& result, const std::vector<Subject>& subjects,
              const Quantity& quantity) {
  Chart chart;
  chart.duration = result.timeline.duration();
  for (const Subject& subject : subjects) {
    chart.series.push_back(seriesOf(result, subject, quantity));
  }
  return chart;
}

Markup speedChart(const record::SessionResult& result, const std::vector<Subject>& subjects) {
  Chart chart = chartOf(result, subjects, [](const record::TimelinePose& pose) {
    return static_cast<double>(pose.speed);
  });
  chart.title = "Speed";
  chart.unit = "m/s";
  chart.least_top = 5.0;
  return chartSvg(chart);
}

Markup gapChart(const record::SessionResult& result, const std::vector<Subject>& subjects) {
  Chart chart = chartOf(result, subjects, [](const record::TimelinePose& pose) {
    return pose.gap < 0.0F ? kNothing : static_cast<double>(pose.gap);
  });
  chart.title = "Gap between the outlines of ego and CBV";
  chart.unit = "m";
  chart.least_top = 5.0;
  if (const auto& gap = result.timeline.smallestGap()) {
    chart.marks.push_back({gap->time, gap->distance,
                           "smallest: " + core::formatFixed(gap->distance, 2) + " m at " +
                               core::formatFixed(gap->time, 2) + " s"});
  }
  return chartSvg(chart);
}

Markup collisionTimeChart(const record::SessionResult& result, std::vector<Subject> subjects) {
  // The ego's line, with anyone, lies below those of the CBVs.
  std::stable_partition(subjects.begin(), subjects.end(),
                        [](const Subject& subject) { return subject.role == VehicleRole::kCbv; });
  Chart chart = chartOf(result, subjects, [](const record::TimelinePose& pose) {
    const auto seconds = static_cast<double>(pose.time_to_collision);
    return seconds < 0.0 || seconds > kLongestTime ? kNothing : seconds;
  });
  chart.title = "2D-TTC: each CBV with the ego; the ego with anyone; up to 10 s";
  chart.unit = "s";
  chart.least_top = kLongestTime;
  return chartSvg(chart);
}

Markup commandChart(const record::SessionResult& result, const std::vector<Subject>& subjects,
                    const std::string& title, float record::TimelinePose::*command) {
  Chart chart = chartOf(result, subjects, [command](const record::TimelinePose& pose) {
    return pose.driven ? static_cast<double>(pose.*command) : kNothing;
  });
  chart.title = title;
  if (command == &record::TimelinePose::steer) chart.bottom = -1.0;
  return chartSvg(chart);
}

Markup subjectLegend(const record::SessionResult& result, const std::vector<Subject>& subjects) {
  Markup items;
  for (const Subject& subject : subjects) {
    items += legendLine("series " + styleOf(subject.role, subject.id, result.cbv),
                        subject.role == VehicleRole::kEgo ? "ego" : "CBV " + subject.id);
  }
  return pageLegend(items);
}

}  // namespace

Markup sessionCharts(const record::SessionResult& result) {
  const std::vector<Subject> subjects = subjectsOf(result);
  if (subjects.empty()) return pageNote("No vehicle was driven.");
  Markup charts = "\n" + speedChart(result, subjects);
  if (result.timeline.smallestGap()) charts += gapChart(result, subjects);
  charts += collisionTimeChart(result, subjects);
  if (!result.cbv.records().empty()) charts += slotChart(result);
  charts += commandChart(result, subjects, "Throttle", &record::TimelinePose::throttle) +
            commandChart(result, subjects, "Brake", &record::TimelinePose::brake) +
            commandChart(result, subjects, "Steering, positive left", &record::TimelinePose::steer);
  return subjectLegend(result, subjects) + element("div", {{"class", "charts"}}, charts) + "\n";
}

}  // namespace cdiff::page
