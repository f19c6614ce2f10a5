// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/system_summary.h"

#include <algorithm>
#include <set>

#include "core/text.h"
#include "evaluation/headline_measures.h"
#include "evaluation/intervals/pooled_estimate.h"
#include "evaluation/system_names.h"
#include "metrics/known_measures.h"
#include "metrics/metric_registry.h"
#include "page/page_parts.h"
#include "record/summary.h"

namespace cdiff::evaluation {
namespace {

using core::Markup;
using Json = nlohmann::ordered_json;

Json intervalJson(const std::optional<Interval>& interval) {
  return interval ? Json::array({interval->low, interval->high}) : Json(nullptr);
}

Json estimateJson(const PooledEstimate& estimate) {
  Json json = {{"kind", metrics::toText(estimate.kind)},
               {"value", record::number(estimate.value)},
               {"interval_95", intervalJson(estimate.interval)},
               {"interval", toText(estimate.interval_kind)},
               {"runs", estimate.runs},
               {"routes", estimate.routes},
               {"seeds", estimate.seeds}};
  if (!estimate.counts()) return json;
  json["events"] = estimate.events;
  json[estimate.per_km ? "km" : "per_runs"] = estimate.exposure;
  json["dispersion"] = record::number(estimate.dispersion);
  json["interval_95_by_routes"] = intervalJson(estimate.clustered);
  return json;
}

const std::vector<std::string>& shownMeasures() {
  namespace known = metrics::known;
  static const std::vector<std::string> names = {
      known::kRouteCompletion.name, known::kDrivingScore.name,    known::kEgoCollisions.name,
      known::kContactsAtFault.name, known::kCbvCollisions.name,   known::kCbvEgoCollisions.name,
      known::kCbvOffRoad.name,      "cbv_passed_percent",         known::kCbvSpeedError.name,
      known::kTtcMean.name,         known::kSpeedShapiroWilk.name};
  return names;
}

/// "cbv_planner diffusion, mode naturalistic": the factors of which the batch has several levels.
std::string nameOf(const System& system, const std::vector<System>& systems) {
  std::vector<std::string> parts;
  for (const auto& [factor, level] : system.factors) {
    const bool varies = std::any_of(systems.begin(), systems.end(),
                                    [&factor = factor, &level = level](const System& other) {
                                      return other.factors.at(factor) != level;
                                    });
    if (varies) parts.push_back(factor + " " + (level.empty() ? "-" : level));
  }
  return parts.empty() ? "all runs" : core::joinText(parts, ", ");
}

std::vector<std::string> headCells() {
  std::vector<std::string> head = {"system", "#runs", "#broken", "#not run", "#routes", "#seeds"};
  head.insert(head.end(), shownMeasures().begin(), shownMeasures().end());
  head.emplace_back("note");
  return head;
}

/// The texts of a row, in the order of the head.
std::vector<std::string> rowCells(const System& system, const std::vector<System>& systems) {
  std::vector<std::string> cells = {nameOf(system, systems)};
  for (const std::size_t count :
       {system.runs, system.failed, system.missing, system.routes, system.seeds})
    cells.push_back(std::to_string(count));
  const bool intervals = showsIntervals(system.routes);
  std::vector<std::string> notes;
  for (const std::string& name : shownMeasures()) {
    const auto found = system.measures.find(name);
    const PooledEstimate estimate =
        found == system.measures.end() ? PooledEstimate() : found->second;
    cells.push_back(estimateText(estimate, 2, intervals));
    const std::string note = estimateNote(estimate, intervals);
    if (!note.empty()) notes.push_back(name + ": " + note);
  }
  cells.push_back(core::joinText(notes, "; "));
  return cells;
}

std::size_t countIntervals(const std::vector<System>& systems) {
  std::size_t count = 0;
  for (const System& system : systems) {
    if (!showsIntervals(system.routes)) continue;
    for (const std::string& name : shownMeasures()) {
      const auto found = system.measures.find(name);
      count += found != system.measures.end() && found->second.interval.has_value();
    }
  }
  return count;
}

/// How to read the table.
std::string readingText(const std::vector<System>& systems) {
  const std::size_t intervals = countIntervals(systems);
  const std::string compare =
      " `cdiff report --compare` tests differences and corrects for their number.";
  if (intervals == 0) return "Figures over all routes; counts are events / km = rate." + compare;
  return "Figures over all routes with 95 % intervals: bootstrap clustered on routes; counts are "
         "events / km = rate with exact Poisson intervals, wider where routes differ. The table "
         "holds " +
         countText(intervals, "interval") + ": about " +
         core::formatFixed(0.05 * static_cast<double>(intervals), 1) +
         " of them are expected to miss." + compare;
}

/// Whether a row shows no intervals.
bool anyWithout(const std::vector<System>& systems) {
  return std::any_of(systems.begin(), systems.end(),
                     [](const System& system) { return !showsIntervals(system.routes); });
}

std::string markdownRow(const std::vector<std::string>& cells) {
  return "| " + core::joinText(cells, " | ") + " |\n";
}

}  // namespace

Json systemsJson(const std::vector<System>& systems) {
  Json list = Json::array();
  for (const System& system : systems) {
    Json factors = Json::object();
    for (const std::string& factor : factorNames()) {
      if (system.factors.count(factor) != 0) factors[factor] = system.factors.at(factor);
    }
    Json measures = Json::object();
    for (const std::string& name : measureNames()) {
      const auto found = system.measures.find(name);
      if (found != system.measures.end()) measures[name] = estimateJson(found->second);
    }
    list.push_back({{"factors", factors},
                    {"runs", system.runs},
                    {"failed", system.failed},
                    {"not_run", system.missing},
                    {"routes", system.routes},
                    {"seeds", system.seeds},
                    {"figures", measures}});
  }
  return list;
}

std::vector<std::string> fewWarnings(const std::vector<System>& systems) {
  std::set<std::string> warnings;
  for (const System& system : systems) {
    if (system.routes == 0) continue;
    const std::string warning = fewWarning(system.seeds, system.routes, true);
    if (!warning.empty()) warnings.insert("Warning: " + warning);
  }
  return {warnings.begin(), warnings.end()};
}

std::string systemsMarkdown(const std::vector<System>& systems) {
  std::string text = "## Systems\n\n" + readingText(systems) + "\n";
  for (const std::string& warning : fewWarnings(systems)) text += "\n" + warning + "\n";
  std::vector<std::string> head = headCells();
  for (std::string& name : head) name.erase(0, name.find_first_not_of('#'));
  text += "\n" + markdownRow(head) + markdownRow(std::vector<std::string>(head.size(), "---"));
  for (const System& system : systems) {
    std::vector<std::string> cells = rowCells(system, systems);
    cells.front() = core::markdownText(cells.front());
    text += markdownRow(cells);
  }
  return text + (anyWithout(systems) ? "\n" + intervalRule() + "\n" : "");
}

namespace {

/// "Driving score", "Route completion [%]"; of events "Collisions of the ego / km".
std::string labelOf(const std::string& measure) {
  const metrics::MeasureDefinition* definition = metrics::findMeasure(measure);
  if (definition == nullptr)
    return measure == "cbv_passed_percent" ? "CBVs that passed their conflict point [%]" : measure;
  const std::string label = definition->label;
  const std::string unit = definition->unit;
  if (unit == "count") return label + " / km";
  return unit.empty() ? label : label + " [" + unit + "]";
}

/// A row for each system, a column for each measure.
Markup measureTable(const std::vector<System>& systems, const SystemNames& names,
                    const std::vector<std::string>& measures) {
  std::vector<std::string> head = {"Planner", "#Runs", "#Routes", "#Seeds"};
  for (const std::string& measure : measures) head.push_back("#" + labelOf(measure));
  page::HtmlTable table(head);
  for (const System& system : systems) {
    const std::size_t lost = system.failed + system.missing;
    std::vector<Markup> cells = {
        names.of(system.factors),
        std::to_string(system.runs) +
            (lost == 0 ? "" : ", " + std::to_string(lost) + " not complete"),
        std::to_string(system.routes), std::to_string(system.seeds)};
    for (const std::string& measure : measures) {
      const auto found = system.measures.find(measure);
      cells.emplace_back(
          estimateText(found == system.measures.end() ? PooledEstimate() : found->second, 2,
                       showsIntervals(system.routes)));
    }
    table.row(cells);
  }
  return table.html();
}

}  // namespace

Markup systemsHtml(const std::vector<System>& systems) {
  const SystemNames names(systems);
  std::vector<std::string> first = {metrics::known::kCbvMovingEgoCollisions.name};
  first.insert(first.end(), headlineMeasures().begin(), headlineMeasures().end());
  const Markup html = measureTable(systems, names, first);
  Markup rest = page::pageNote(readingText(systems));
  rest += measureTable(systems, names, shownMeasures());
  if (anyWithout(systems)) rest += page::pageNote(intervalRule());
  return html + page::pageFold("More measures, and how to read them", rest);
}

}  // namespace cdiff::evaluation
