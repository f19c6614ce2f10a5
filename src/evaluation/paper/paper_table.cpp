// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/paper/paper_table.h"

#include <algorithm>
#include <set>

#include "core/csv.h"
#include "core/text.h"
#include "evaluation/intervals/pooled_estimate.h"
#include "evaluation/paper/cell_sums.h"
#include "planners/registry.h"
#include "session/session_request.h"

namespace cdiff::evaluation {
namespace {

/// The cells of a line of CSV for what is published.
std::vector<std::string> publishedCells(const TableCell& cell) {
  return {core::csvNumber(cell.paper.mean), core::csvNumber(cell.paper.deviation),
          core::csvNumber(cell.repository.mean), core::csvNumber(cell.repository.deviation)};
}

/// And for ours.
std::vector<std::string> ownCells(const TableCell& cell, bool rift) {
  const Statistics& statistics = rift ? cell.rift : cell.seeds;
  std::optional<double> low;
  std::optional<double> high;
  if (statistics.interval) {
    low = statistics.interval->low;
    high = statistics.interval->high;
  }
  const bool counted = !rift && cell.events.has_value();
  return {core::csvNumber(statistics.mean),
          core::csvNumber(statistics.standard_deviation),
          core::csvNumber(low),
          core::csvNumber(high),
          std::to_string(statistics.n),
          std::to_string(rift ? cell.rift_routes : cell.routes),
          counted ? std::to_string(*cell.events) : "",
          counted ? core::csvNumber(cell.kilometers) : "",
          std::to_string(cell.runs),
          std::to_string(rift ? cell.rift_used : cell.used),
          std::to_string(cell.failed),
          std::to_string(cell.missing),
          statistics.mean     ? ""
          : cell.note.empty() ? kNoRunHasIt
                              : cell.note};
}

std::string csvLine(const Table& table, std::size_t row, std::size_t column, bool rift) {
  const TableCell& cell = table.cells[row][column];
  const TableColumn& head = table.definition.columns[column];
  std::vector<std::string> cells = {table.definition.rows[row].name, head.name, head.unit,
                                    rift ? "rift_compat" : "clean"};
  for (const auto& further : {publishedCells(cell), ownCells(cell, rift)})
    cells.insert(cells.end(), further.begin(), further.end());
  return core::csvRow(cells);
}

std::string statisticsText(const Statistics& statistics, bool with_interval) {
  const std::string plus_minus = " \xC2\xB1 ";
  std::string text = core::formatFixed(*statistics.mean, 2);
  if (statistics.standard_deviation)
    text += plus_minus + core::formatFixed(*statistics.standard_deviation, 2);
  return with_interval ? text + intervalText(statistics.interval, 2) : text;
}

bool anyFigure(const std::vector<TableCell>& row) {
  return std::any_of(row.begin(), row.end(), [](const TableCell& cell) { return cell.seeds.mean; });
}

}  // namespace

bool showsIntervals(const std::vector<TableCell>& row) {
  return anyFigure(row) && std::all_of(row.begin(), row.end(), [](const TableCell& cell) {
           return (!cell.seeds.mean || showsIntervals(cell.routes)) &&
                  (!cell.rift.mean || showsIntervals(cell.rift_routes));
         });
}

bool anyIntervals(const Table& table) {
  return std::any_of(table.cells.begin(), table.cells.end(),
                     [](const auto& row) { return showsIntervals(row); });
}

bool anyRowWithout(const Table& table) {
  return std::any_of(table.cells.begin(), table.cells.end(),
                     [](const auto& row) { return anyFigure(row) && !showsIntervals(row); });
}

std::string tableCsv(const Table& table) {
  std::string text =
      "row,column,unit,definition,paper_mean,paper_std,rift_repository_mean,rift_repository_std,"
      "mean,std,interval_95_low,interval_95_high,seeds,routes,events,km,runs,runs_with_figure,"
      "runs_failed,runs_not_run,note\n";
  for (std::size_t row = 0; row < table.cells.size(); ++row) {
    for (std::size_t column = 0; column < table.cells[row].size(); ++column) {
      text += csvLine(table, row, column, false);
      if (!table.definition.columns[column].rift_key.empty())
        text += csvLine(table, row, column, true);
    }
  }
  return text;
}

std::string cellText(const TableCell& cell, bool with_interval) {
  if (!cell.seeds.mean) return "(" + cell.note + ")";
  const std::string events = cell.events ? std::to_string(*cell.events) + " / " +
                                               core::formatFixed(cell.kilometers, 3) + " km = "
                                         : std::string();
  return events + statisticsText(cell.seeds, with_interval) + " (" +
         countText(cell.routes, "route") + ", " + countText(cell.seeds.n, "seed") + ", " +
         countText(cell.used, "run") +
         (cell.failed > 0 ? ", " + std::to_string(cell.failed) + " failed" : "") +
         (cell.missing > 0 ? ", " + std::to_string(cell.missing) + " not run" : "") + ")";
}

std::string paperText(const PaperFigure& figure) {
  if (!figure.mean) return "";
  return core::formatFixed(*figure.mean, 2) +
         (figure.deviation ? " \xC2\xB1 " + core::formatFixed(*figure.deviation, 2) : "");
}

std::string riftText(const TableCell& cell, bool with_interval) {
  return cell.rift.mean ? statisticsText(cell.rift, with_interval) : "";
}

namespace {

std::string withSubject(std::string key, const std::string& subject) {
  const std::size_t place = key.find("{}");
  return place == std::string::npos ? key : key.replace(place, 2, subject);
}

/// Modes, joined, in which the batch ran what else has these levels; empty where it ran the mode of
/// `levels`, or where they have none.
std::string otherModes(const Factors& levels, const std::vector<BatchRun>& runs) {
  const auto wanted = levels.find("mode");
  if (wanted == levels.end()) return "";
  Factors others = levels;
  others.erase("mode");
  others.erase("guidance_profile");  // which follows the mode
  std::set<std::string> modes;
  for (const BatchRun* run : runsWith(runs, others)) modes.insert(run->record.factors.at("mode"));
  if (modes.count(wanted->second) != 0) return "";
  return core::joinText({modes.begin(), modes.end()}, ", ");
}

void countRuns(const std::vector<const BatchRun*>& runs, TableCell& cell) {
  cell.runs = runs.size();
  for (const BatchRun* run : runs) {
    cell.failed += run->record.failed();
    cell.missing += !run->record.complete() && !run->record.failed();
  }
}

void addRift(const CellSums& sums, const std::string& key, RouteBootstrap& bootstrap,
             TableCell& cell) {
  cell.rift = sums.overSeeds(bootstrap, poolingAt(key));
  cell.rift_routes = sums.routes();
  cell.rift_used = sums.used();
}

TableCell fillCell(const TableRow& row, std::size_t index, const TableColumn& column,
                   const std::vector<BatchRun>& runs, RouteBootstrap& bootstrap) {
  Factors levels = row.levels;
  levels.insert(column.levels.begin(), column.levels.end());
  const auto own = runsWith(runs, levels);
  TableCell cell;
  if (index < row.paper.size()) cell.paper = row.paper[index];
  if (index < row.repository.size()) cell.repository = row.repository[index];
  countRuns(own, cell);
  const std::string weight = withSubject(column.weight, row.subject);
  if (!column.rift_key.empty())
    addRift(CellSums(own, column.rift_key, weight), column.rift_key, bootstrap, cell);
  const CellSums sums(own, withSubject(column.key, row.subject), weight);
  const metrics::PoolingRule rule = poolingAt(column.key);
  if (rule.kind == metrics::Pooling::kRate) {
    cell.events = sums.events();
    cell.kilometers = sums.kilometers();
    cell.seeds = sums.ofEvents(bootstrap);
  } else {
    cell.seeds = sums.overSeeds(bootstrap, rule);
  }
  cell.used = sums.used();
  cell.routes = sums.routes();
  if (!cell.seeds.mean) cell.note = emptyReason(levels, runs, kNoRunHasIt);
  return cell;
}

}  // namespace

std::string emptyReason(const Factors& levels, const std::vector<BatchRun>& runs,
                        const std::string& otherwise) {
  const std::vector<std::string> known = planners::plannerNames();
  for (const char* factor : {"ego_planner", "cbv_planner"}) {
    const auto level = levels.find(factor);
    if (level == levels.end()) continue;
    if (std::find(known.begin(), known.end(), level->second) == known.end())
      return "not implemented";
  }
  const auto own = runsWith(runs, levels);
  if (own.empty()) {
    const std::string modes = otherModes(levels, runs);
    return modes.empty() ? "not run" : "not applicable in mode " + modes;
  }
  const bool completed = std::any_of(own.begin(), own.end(),
                                     [](const BatchRun* run) { return run->record.complete(); });
  return completed ? otherwise : "no run completed";
}

Table fillTable(const TableDefinition& definition, const std::vector<BatchRun>& runs) {
  RouteBootstrap bootstrap;
  Table table;
  table.definition = definition;
  for (const TableRow& row : definition.rows) {
    table.cells.emplace_back();
    for (std::size_t i = 0; i < definition.columns.size(); ++i)
      table.cells.back().push_back(fillCell(row, i, definition.columns[i], runs, bootstrap));
    addSettings(row, definition, runs, table);
  }
  return table;
}

}  // namespace cdiff::evaluation
