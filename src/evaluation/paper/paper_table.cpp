// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/paper/paper_table.h"

#include <algorithm>

#include "core/text.h"
#include "planners/registry.h"
#include "session/session_request.h"

namespace cdiff::evaluation {

std::string PaperSystem::planner() const {
  const std::string found = planners::plannerTitled(title);
  return found.empty() ? std::string("(") + title + " is not implemented)" : found;
}

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

std::string withSubject(std::string key, const std::string& subject) {
  const std::size_t place = key.find("{}");
  return place == std::string::npos ? key : key.replace(place, 2, subject);
}

/// Weighted values of one seed.
struct SeedSum {
  double sum = 0.0;
  double weight = 0.0;
};

/// `key` over the seeds of complete runs; runs without it, or of weight 0, are passed over.
Statistics weightedOverSeeds(const std::vector<const BatchRun*>& runs, const std::string& key,
                             const std::string& weight, std::size_t& used) {
  std::map<std::string, SeedSum> seeds;
  used = 0;
  for (const BatchRun* run : runs) {
    const auto value = run->number(key);
    const double share = weight.empty() ? 1.0 : run->number(weight).value_or(0.0);
    if (!value || share <= 0.0) continue;
    SeedSum& seed = seeds[run->record.factors.at("seed")];
    seed.sum += share * *value;
    seed.weight += share;
    ++used;
  }
  std::vector<double> means;
  for (const auto& [name, seed] : seeds) means.push_back(seed.sum / seed.weight);
  return statisticsOf(means);
}

/// Why a cell without figures is empty.
std::string reasonOf(const Factors& levels, const TableCell& cell) {
  const std::vector<std::string> known = planners::plannerNames();
  for (const char* factor : {"ego_planner", "cbv_planner"}) {
    const auto level = levels.find(factor);
    if (level == levels.end()) continue;
    if (std::find(known.begin(), known.end(), level->second) == known.end())
      return "not implemented";
  }
  if (cell.runs == 0) return "not run";
  if (cell.failed == cell.runs) return "no run completed";
  return "no run has this measure";
}

TableCell fillCell(const TableRow& row, std::size_t index, const TableColumn& column,
                   const std::vector<BatchRun>& runs) {
  Factors levels = row.levels;
  levels.insert(column.levels.begin(), column.levels.end());
  const auto own = runsWith(runs, levels);
  TableCell cell;
  if (index < row.paper.size()) cell.paper = row.paper[index];
  cell.runs = own.size();
  for (const BatchRun* run : own) cell.failed += !run->record.complete();
  const std::string weight = withSubject(column.weight, row.subject);
  if (!column.rift_key.empty())
    cell.rift = weightedOverSeeds(own, column.rift_key, weight, cell.used);
  cell.seeds = weightedOverSeeds(own, withSubject(column.key, row.subject), weight, cell.used);
  if (!cell.seeds.mean) cell.note = reasonOf(levels, cell);
  return cell;
}

std::string csvLine(const Table& table, std::size_t row, std::size_t column, bool rift) {
  const TableCell& cell = table.cells[row][column];
  const Statistics& statistics = rift ? cell.rift : cell.seeds;
  const TableColumn& head = table.definition.columns[column];
  std::optional<double> low;
  std::optional<double> high;
  if (statistics.half_width) {
    low = *statistics.mean - *statistics.half_width;
    high = *statistics.mean + *statistics.half_width;
  }
  return core::csvRow(
      {table.definition.rows[row].name, head.name, head.unit, rift ? "rift_compat" : "clean",
       core::csvNumber(cell.paper.mean), core::csvNumber(cell.paper.deviation),
       core::csvNumber(statistics.mean), core::csvNumber(statistics.standard_deviation),
       core::csvNumber(low), core::csvNumber(high), std::to_string(statistics.n),
       std::to_string(cell.runs), std::to_string(cell.used), std::to_string(cell.failed),
       statistics.mean     ? ""
       : cell.note.empty() ? "no run has this measure"
                           : cell.note});
}

std::string statisticsText(const Statistics& statistics) {
  const std::string plus_minus = " \xC2\xB1 ";
  std::string text = core::formatFixed(*statistics.mean, 2);
  if (!statistics.half_width) return text;
  return text + plus_minus + core::formatFixed(*statistics.standard_deviation, 2) + " [" +
         core::formatFixed(*statistics.mean - *statistics.half_width, 2) + ", " +
         core::formatFixed(*statistics.mean + *statistics.half_width, 2) + "]";
}

/// Adds the row to the settings of each of its complete runs.
void addSettings(const TableRow& row, const TableDefinition& definition,
                 const std::vector<BatchRun>& runs, std::vector<TableSettings>& settings) {
  for (const TableColumn& column : definition.columns) {
    for (const BatchRun* run : runsWith(runs, merged(row.levels, column.levels))) {
      if (run->settings.empty()) continue;
      auto found = std::find_if(settings.begin(), settings.end(),
                                [&](const auto& entry) { return entry.text == run->settings; });
      if (found == settings.end()) found = settings.insert(settings.end(), {{}, run->settings});
      if (found->rows.empty() || found->rows.back() != row.name) found->rows.push_back(row.name);
    }
  }
}

}  // namespace

Table fillTable(const TableDefinition& definition, const std::vector<BatchRun>& runs) {
  Table table;
  table.definition = definition;
  for (const TableRow& row : definition.rows) {
    table.cells.emplace_back();
    for (std::size_t i = 0; i < definition.columns.size(); ++i)
      table.cells.back().push_back(fillCell(row, i, definition.columns[i], runs));
    addSettings(row, definition, runs, table.settings);
  }
  return table;
}

std::string tableCsv(const Table& table) {
  std::string text =
      "row,column,unit,definition,paper_mean,paper_std,mean,std,interval_95_low,interval_95_high,"
      "seeds,runs,runs_with_figure,runs_failed,note\n";
  for (std::size_t row = 0; row < table.cells.size(); ++row) {
    for (std::size_t column = 0; column < table.cells[row].size(); ++column) {
      text += csvLine(table, row, column, false);
      if (!table.definition.columns[column].rift_key.empty())
        text += csvLine(table, row, column, true);
    }
  }
  return text;
}

std::vector<std::string> settingsLines(const Table& table) {
  std::vector<std::string> lines;
  for (const TableSettings& entry : table.settings)
    lines.push_back(core::joinText(entry.rows, " | ") + ": " + entry.text + ".");
  return lines;
}

std::string cellText(const TableCell& cell) {
  if (!cell.seeds.mean) return "(" + cell.note + ")";
  return statisticsText(cell.seeds) + " (" + std::to_string(cell.seeds.n) +
         (cell.seeds.n == 1 ? " seed, " : " seeds, ") + std::to_string(cell.used) +
         (cell.used == 1 ? " run" : " runs") +
         (cell.failed > 0 ? ", " + std::to_string(cell.failed) + " failed" : "") + ")";
}

std::string paperText(const PaperFigure& figure) {
  if (!figure.mean) return "";
  return core::formatFixed(*figure.mean, 2) +
         (figure.deviation ? " \xC2\xB1 " + core::formatFixed(*figure.deviation, 2) : "");
}

std::string riftText(const TableCell& cell) {
  return cell.rift.mean ? statisticsText(cell.rift) : "";
}

}  // namespace cdiff::evaluation
