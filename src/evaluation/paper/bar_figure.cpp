// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/paper/bar_figure.h"

#include <algorithm>
#include <set>

#include "core/text.h"
#include "evaluation/paper/paper_figures.h"
#include "evaluation/paper/paper_systems.h"
#include "evaluation/paper/paper_table.h"
#include "page/pictures/charts.h"

namespace cdiff::evaluation {
namespace {

constexpr double kHalfLetter = 3.6;  // half the width of a letter of a name [px]

using core::Markup;
using core::shortNumber;
using page::svgPlace;

constexpr double kBarShare = 0.8;  // of a group's width that bars fill
const std::string kPaperStyle = page::systemStyle(7);

/// Columns that one picture shows, by their places in the table.
struct Bars {
  const Table& table;
  std::vector<std::size_t> columns = {};

  const TableColumn& column(std::size_t i) const { return table.definition.columns[columns[i]]; }
};

/// A picture for each TableColumn::panel, in the order of the columns.
std::vector<Bars> picturesOf(const Table& table) {
  std::vector<Bars> pictures;
  for (std::size_t i = 0; i < table.definition.columns.size(); ++i) {
    const std::string& panel = table.definition.columns[i].panel;
    if (pictures.empty() || pictures.back().column(0).panel != panel)
      pictures.push_back(Bars{table});
    pictures.back().columns.push_back(i);
  }
  return pictures;
}

double topOf(const Bars& bars) {
  double top = 1.0;
  for (const auto& row : bars.table.cells) {
    for (const std::size_t column : bars.columns) {
      const TableCell& cell = row[column];
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
Markup groupOf(const Bars& bars, std::size_t row, const page::ChartAxes& axes) {
  const auto& cells = bars.table.cells[row];
  const double width = kBarShare / (2.0 * static_cast<double>(bars.columns.size()));
  double left = static_cast<double>(row) + 0.5 * (1.0 - kBarShare);
  Markup svg;
  for (std::size_t i = 0; i < bars.columns.size(); ++i) {
    const TableCell& cell = cells[bars.columns[i]];
    if (cell.seeds.mean) {
      svg += bar(axes, left, width, *cell.seeds.mean, page::systemStyle(i));
      if (showsIntervals(cells)) svg += interval(axes, left + 0.45 * width, cell.seeds);
    }
    left += width;
    if (cell.paper.mean) svg += bar(axes, left, width, *cell.paper.mean, kPaperStyle);
    left += width;
  }
  return svg + groupText(bars.table, row, axes);
}

page::Panel barPanel(const Bars& bars) {
  const Table& table = bars.table;
  const page::ChartAxes axes(0.0, static_cast<double>(table.cells.size()), 0.0, topOf(bars));
  page::Panel panel;
  panel.title = bars.column(0).panel;
  panel.width = page::kChartWidth;
  panel.height = page::kChartHeight + 14.0;
  panel.content = axes.valueGrid() + "\n";
  for (std::size_t row = 0; row < table.cells.size(); ++row)
    panel.content += groupOf(bars, row, axes);
  return panel;
}

/// A sentence where the network of the CBVs is not given the same in all columns; else nothing.
std::string conditioningNote(const TableDefinition& definition, const std::vector<BatchRun>& runs) {
  std::set<std::string> levels;
  std::vector<std::string> parts;
  for (const TableColumn& column : definition.columns) {
    if (column.panel != definition.columns.front().panel) continue;  // the same runs again
    std::set<std::string> own;
    for (const TableRow& row : definition.rows) {
      for (const BatchRun* run : runsWith(runs, merged(row.levels, column.levels))) {
        if (!run->cbv_conditioning.empty()) own.insert(run->cbv_conditioning);
      }
    }
    if (own.empty()) continue;
    const std::string text = core::joinText({own.begin(), own.end()}, " and ");
    levels.insert(text);
    parts.push_back(column.name + " " + text);
  }
  if (levels.size() < 2) return "";
  return "The columns differ in conditioning, too (what the network of the CBVs is given): " +
         core::joinText(parts, "; ") + ".";
}

/// The numbers of a row; one word where no cell has any, all for the same reason.
std::string rowNote(const Table& table, const std::vector<TableCell>& cells) {
  const bool nothing = std::all_of(cells.begin(), cells.end(), [&](const TableCell& cell) {
    return !cell.seeds.mean && !cell.paper.mean && cell.note == cells.front().note;
  });
  if (nothing) return cells.front().note;
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::string paper = paperText(cells[i].paper);
    parts.push_back(table.definition.columns[i].name + " " +
                    cellText(cells[i], showsIntervals(cells)) +
                    (paper.empty() ? "" : ", paper " + paper));
  }
  return core::joinText(parts, "; ");
}

/// Numbers below the bars, one line a row.
std::vector<std::string> notesOf(const Table& table) {
  std::vector<std::string> notes;
  for (std::size_t row = 0; row < table.cells.size(); ++row) {
    notes.push_back((namesFit(table) ? "" : std::to_string(row + 1) + ". ") +
                    table.definition.rows[row].name + ": " + rowNote(table, table.cells[row]));
  }
  notes.push_back(table.definition.note);
  if (anyRowWithout(table)) notes.push_back(intervalRule());
  for (const std::string& line : table.definition.footnotes) notes.push_back(line);
  for (const std::string& line : settingsLines(table)) notes.push_back(line);
  return notes;
}

}  // namespace

Figure barFigure(const TableDefinition& definition, const std::vector<BatchRun>& runs) {
  const Table table = fillTable(definition, runs);
  const std::vector<Bars> pictures = picturesOf(table);
  const std::string with_interval = anyIntervals(table) ? ", with its 95 % interval" : "";
  Figure figure;
  figure.id = definition.id;
  figure.csv = tableCsv(table);
  figure.sheet.title = definition.title + " [" + definition.columns.front().unit + "]";
  for (std::size_t i = 0; i < pictures.front().columns.size(); ++i) {
    figure.sheet.legend.emplace_back(page::systemStyle(i),
                                     pictures.front().column(i).name + with_interval);
  }
  figure.sheet.legend.emplace_back(kPaperStyle, "as the paper prints it");
  for (const Bars& bars : pictures) figure.sheet.rows.push_back({barPanel(bars)});
  figure.sheet.notes = notesOf(table);
  const std::string conditioning = conditioningNote(definition, runs);
  if (!conditioning.empty()) figure.sheet.notes.push_back(conditioning);
  return figure;
}

}  // namespace cdiff::evaluation
