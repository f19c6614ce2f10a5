// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/paper/paper_table.h"

#include <algorithm>

#include "core/csv.h"
#include "core/text.h"
#include "evaluation/intervals/pooled_estimate.h"
#include "planners/registry.h"
#include "session/session_request.h"

namespace cdiff::evaluation {

std::string PaperSystem::planner() const { return planners::plannerTitled(title); }

const std::vector<PaperSystem>& paperEgoPlanners() {
  static const std::vector<PaperSystem> systems = {paper::kPdmLite,   paper::kPlanT,
                                                   paper::kUniAd,     paper::kVad,
                                                   paper::kDiffusion, paper::kPaperMethod};
  return systems;
}

const std::vector<PaperSystem>& paperCbvPlanners() {
  static const std::vector<PaperSystem> systems = {paper::kPpo, paper::kPluto, paper::kRift,
                                                   paper::kDiffusion, paper::kPaperMethod};
  return systems;
}

const std::vector<PaperSystem>& paperExecutions() {
  static const std::vector<PaperSystem> systems = {
      {paper::kTwoStage.title, "Two-stage trajectory-then-PID (method default)"},
      {paper::kDiffusion.title, "End-to-end control (method default)"},
      {paper::kTwoStage.title, "Two-stage trajectory-then-PID (method paper)", "paper"},
      {paper::kDiffusion.title, "End-to-end control (method paper)", "paper"}};
  return systems;
}

Factors egoLevel(const PaperSystem& system) { return {{"ego_planner", system.planner()}}; }

Factors cbvLevels(const PaperSystem& system, const char* mode) {
  return {{"cbv_planner", system.planner()},
          {"method", system.method},
          {"mode", mode},
          {"guidance_profile", session::loadMethod(system.method).profileOf(mode)}};
}

Factors merged(Factors levels, const Factors& others) {
  levels.insert(others.begin(), others.end());
  return levels;
}

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
          std::to_string(cell.routes),
          counted ? std::to_string(*cell.events) : "",
          counted ? core::csvNumber(cell.kilometers) : "",
          std::to_string(cell.runs),
          std::to_string(cell.used),
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
           return !cell.seeds.mean || showsIntervals(cell.routes);
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

}  // namespace cdiff::evaluation
