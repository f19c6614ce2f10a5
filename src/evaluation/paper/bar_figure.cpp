// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "evaluation/paper/paper_figures.h"
#include "evaluation/paper/paper_table.h"
#include "metrics/known_measures.h"
#include "page/pictures/charts.h"

namespace cdiff::evaluation {
namespace {

constexpr double kHalfLetter = 3.6;  // half the width of a letter of a name [px]

using core::Markup;
using core::shortNumber;
using page::svgPlace;

constexpr double kBarShare = 0.8;  // of a group's width that bars fill
const std::string kPaperStyle = page::systemStyle(7);

double topOf(const Table& table) {
  double top = 1.0;
  for (const auto& row : table.cells) {
    for (const TableCell& cell : row) {
      top = std::max(top, cell.paper.mean.value_or(0.0));
      top = std::max(top, cell.seeds.mean.value_or(0.0));
      if (cell.seeds.interval) top = std::max(top, cell.seeds.interval->high);
    }
  }
  return top;
}

Markup bar(const page::ChartAxes& axes, double left, double width, double value,
           const std::string& style) {
  const std::string data =
      "M" + svgPlace(axes.x(left), axes.y(0.0)) + "V" + shortNumber(axes.y(value)) + "H" +
      shortNumber(axes.x(left + 0.9 * width)) + "V" + shortNumber(axes.y(0.0)) + "Z";
  return core::element("path", {{"class", "bar " + style}, {"d", data}});
}

Markup interval(const page::ChartAxes& axes, double x, const Statistics& statistics) {
  if (!statistics.interval) return {};
  const std::string data = "M" + svgPlace(axes.x(x), axes.y(statistics.interval->low)) + "V" +
                           shortNumber(axes.y(statistics.interval->high));
  return core::element("path", {{"class", "error"}, {"d", data}});
}

/// Whether the rows' names have room below the bars, in two lines that take turns.
bool namesFit(const Table& table) {
  const double room = 2.0 * page::kChartWidth / static_cast<double>(table.definition.rows.size());
  return std::all_of(table.definition.rows.begin(), table.definition.rows.end(),
                     [&](const TableRow& row) {
                       return 2.0 * kHalfLetter * static_cast<double>(row.name.size()) <= room;
                     });
}

/// A row's name, or its number among the notes where names have no room; and why it has no bars.
Markup groupText(const Table& table, std::size_t row, const page::ChartAxes& axes) {
  const auto& cells = table.cells[row];
  const double middle = axes.x(static_cast<double>(row) + 0.5);
  const bool empty = std::none_of(cells.begin(), cells.end(),
                                  [](const TableCell& cell) { return cell.seeds.mean; });
  const double lower = row % 2 == 0 ? 0.0 : 14.0;  // so that names do not run into each other
  const std::string name =
      namesFit(table) ? table.definition.rows[row].name : std::to_string(row + 1);
  const double half =
      std::min(kHalfLetter * static_cast<double>(name.size()), 0.5 * page::kChartWidth);
  Markup svg = page::chartText("tick middle", std::clamp(middle, half, page::kChartWidth - half),
                               page::kChartHeight - 9.0 + lower, name);
  if (empty && !cells.empty())
    svg +=
        page::chartText("note middle", middle, page::kChartTop + 10.0 + lower, cells.front().note);
  return svg + "\n";
}

/// Bars of one row: per column ours and the paper's.
Markup groupOf(const Table& table, std::size_t row, const page::ChartAxes& axes) {
  const auto& cells = table.cells[row];
  const double width = kBarShare / (2.0 * static_cast<double>(cells.size()));
  double left = static_cast<double>(row) + 0.5 * (1.0 - kBarShare);
  Markup svg;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const TableCell& cell = cells[i];
    if (cell.seeds.mean) {
      svg += bar(axes, left, width, *cell.seeds.mean, page::systemStyle(i)) +
             interval(axes, left + 0.45 * width, cell.seeds);
    }
    left += width;
    if (cell.paper.mean) svg += bar(axes, left, width, *cell.paper.mean, kPaperStyle);
    left += width;
  }
  return svg + groupText(table, row, axes);
}

/// Numbers below the bars, one line a row.
std::vector<std::string> notesOf(const Table& table) {
  std::vector<std::string> notes;
  for (std::size_t row = 0; row < table.cells.size(); ++row) {
    std::string text = (namesFit(table) ? "" : std::to_string(row + 1) + ". ") +
                       table.definition.rows[row].name + ": ";
    for (std::size_t i = 0; i < table.cells[row].size(); ++i) {
      const TableCell& cell = table.cells[row][i];
      const std::string paper = paperText(cell.paper);
      text += (i > 0 ? "; " : "") + table.definition.columns[i].name + " " + cellText(cell) +
              (paper.empty() ? "" : ", paper " + paper);
    }
    notes.push_back(text);
  }
  notes.push_back(table.definition.note);
  for (const std::string& line : settingsLines(table)) notes.push_back(line);
  return notes;
}

}  // namespace

Figure barFigure(const TableDefinition& definition, const std::vector<BatchRun>& runs) {
  const Table table = fillTable(definition, runs);
  Figure figure;
  figure.id = definition.id;
  figure.csv = tableCsv(table);
  figure.sheet.title = definition.title + " [" + definition.columns.front().unit + "]";
  for (std::size_t i = 0; i < definition.columns.size(); ++i) {
    figure.sheet.legend.emplace_back(page::systemStyle(i),
                                     definition.columns[i].name + ", with its 95 % interval");
  }
  figure.sheet.legend.emplace_back(kPaperStyle, "as the paper prints it");
  const page::ChartAxes axes(0.0, static_cast<double>(definition.rows.size()), 0.0, topOf(table));
  page::Panel panel;
  panel.width = page::kChartWidth;
  panel.height = page::kChartHeight + 14.0;
  panel.content = axes.valueGrid() + "\n";
  for (std::size_t row = 0; row < table.cells.size(); ++row)
    panel.content += groupOf(table, row, axes);
  figure.sheet.rows = {{panel}};
  figure.sheet.notes = notesOf(table);
  return figure;
}

namespace {

TableColumn collisionsPerKilometre() {
  return {"CPK",
          "1/km",
          metrics::known::kCollisionsPerKm.place,
          metrics::known::kCbvDistance.place,
          metrics::known::kRiftCollisionsPerKm.place,
          {}};
}

}  // namespace

TableDefinition collisionFigure() {
  TableDefinition table = {
      "figure_4",
      "Figure 4. Collisions of CBVs per km without and with collision-seeking "
      "guidance",
      "The paper prints the values of PDM-Lite alone, in its text. What the two columns of a "
      "method differ in besides the objectives stands in the settings of its runs.",
      "Ego planner",
      {},
      {}};
  for (const PaperSystem& own : {paper::kDiffusion, paper::kPaperMethod}) {
    for (const char* mode : {kNaturalistic, kSafetyCritical}) {
      TableColumn column = collisionsPerKilometre();
      column.name = std::string("E2E-CDiff") + (mode == kSafetyCritical ? " w/ coll" : "") +
                    " (method " + own.method + ")";
      column.levels = cbvLevels(own, mode);
      table.columns.push_back(column);
    }
  }
  for (const PaperSystem& ego : paperEgoPlanners()) {
    if (ego.planner() == paper::kDiffusion.planner()) continue;
    table.rows.push_back({ego.name, egoLevel(ego), {}, ""});
  }
  table.rows.front().paper = {{5.68, {}}, {20.77, {}}, {5.68, {}}, {20.77, {}}};
  return table;
}

TableDefinition latencyFigure() {
  const std::optional<double> paper[] = {3.96, 6.46, 734.03, 379.50, 856.66};
  TableDefinition table = {
      "figure_8",
      "Figure 8. Latency of ego planners per decision",
      "Wall-clock time of a decision (as CBV planner: of all CBVs together), the image being there "
      "already. The paper prints means; they stand beside "
      "our medians. A seed's value is the mean over its runs, weighted "
      "by decisions.",
      "Ego planner",
      {{"p50", "ms", "/planner_latency_ms/{}/p50", "/planner_latency_ms/{}/n", "", {}},
       {"p95", "ms", "/planner_latency_ms/{}/p95", "/planner_latency_ms/{}/n", "", {}}},
      {}};
  for (std::size_t i = 0; i < paperEgoPlanners().size(); ++i) {
    const PaperSystem& ego = paperEgoPlanners()[i];
    const auto printed = paper[std::min(i, std::size(paper) - 1)];
    Factors levels = egoLevel(ego);
    if (ego.planner() == paper::kDiffusion.planner()) levels["method"] = ego.method;
    table.rows.push_back({ego.name, levels, {{printed, {}}}, "ego:" + std::string(ego.planner())});
  }
  for (const PaperSystem& cbv : paperExecutions()) {
    const Factors levels = {{"cbv_planner", cbv.planner()}, {"method", cbv.method}};
    table.rows.push_back(
        {"CBV: " + std::string(cbv.name), levels, {}, "cbv:" + std::string(cbv.planner())});
  }
  return table;
}

}  // namespace cdiff::evaluation
