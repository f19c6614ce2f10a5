// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/paper/paper_table.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/text.h"
#include "evaluation/intervals/intervals.h"
#include "evaluation/intervals/pooled_estimate.h"
#include "metrics/metric_registry.h"
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

/// What the runs of a cell add to a figure, by route and seed.
class CellSums {
 public:
  /// Complete runs that have `key`; those of weight 0 are passed over.
  CellSums(const std::vector<const BatchRun*>& runs, const std::string& key,
           const std::string& weight) {
    for (const BatchRun* run : runs) {
      const auto value = run->number(key);
      const double share = weight.empty() ? 1.0 : run->number(weight).value_or(0.0);
      if (value && share > 0.0) add(*run, *value, share);
    }
  }

  std::size_t used() const { return used_; }
  std::size_t routes() const { return routes_.size(); }

  /// Mean and deviation over seeds of the weighted means within them; interval by routes.
  Statistics overSeeds(RouteBootstrap& bootstrap) const {
    Statistics statistics = statisticsOf(seedMeans(allRoutes()));
    statistics.interval = bootstrap.interval(routes(), [&](const std::uint32_t* first) {
      return statisticsOf(seedMeans({first, first + routes()})).mean;
    });
    return statistics;
  }

  /// The same of events per km, where weights are metres; counts go to the cell.
  Statistics ofEvents(RouteBootstrap& bootstrap, TableCell& cell) const {
    Statistics statistics = statisticsOf(seedMeans(allRoutes()));
    cell.events = static_cast<std::size_t>(std::llround(events_));
    cell.kilometres = kilometres_;
    statistics.interval = std::nullopt;
    if (used_ == 0) return statistics;
    statistics.mean = events_ / kilometres_;
    statistics.interval =
        rateInterval(*cell.events, kilometres_, bootstrap.valueInterval(perKilometre()));
    return statistics;
  }

 private:
  void add(const BatchRun& run, double value, double share) {
    const auto& factors = run.record.factors;
    const std::size_t seed = seeds_.emplace(factors.at("seed"), seeds_.size()).first->second;
    const std::size_t route = names_.emplace(factors.at("scenario"), names_.size()).first->second;
    if (route == routes_.size()) routes_.emplace_back();
    RouteSum& sum = routes_[route][seed];
    sum.sum += share * value;
    sum.weight += share;
    events_ += std::round(share * value / 1000.0);
    kilometres_ += share / 1000.0;
    ++used_;
  }

  /// Events and km of each route.
  RouteSums perKilometre() const {
    RouteSums sums;
    for (const auto& route : routes_) {
      sums.emplace_back();
      for (const auto& [seed, sum] : route) {
        sums.back().sum += sum.sum / 1000.0;
        sums.back().weight += sum.weight / 1000.0;
      }
    }
    return sums;
  }

  std::vector<std::uint32_t> allRoutes() const {
    std::vector<std::uint32_t> all(routes());
    std::iota(all.begin(), all.end(), 0U);
    return all;
  }

  /// Of these routes, by seed.
  std::vector<double> seedMeans(const std::vector<std::uint32_t>& drawn) const {
    RouteSums sums(seeds_.size());
    for (const std::uint32_t route : drawn) {
      for (const auto& [seed, sum] : routes_[route]) {
        sums[seed].sum += sum.sum;
        sums[seed].weight += sum.weight;
      }
    }
    std::vector<double> means;
    for (const RouteSum& sum : sums) {
      if (sum.weight > 0.0) means.push_back(sum.sum / sum.weight);
    }
    return means;
  }

  std::map<std::string, std::size_t> seeds_;  ///< places by name
  std::map<std::string, std::size_t> names_;  ///< of routes
  std::vector<std::map<std::size_t, RouteSum>> routes_;
  std::size_t used_ = 0;
  double events_ = 0.0;  ///< where values are per km and weights metres
  double kilometres_ = 0.0;
};

/// Whether a column shows events per km: by the definition of the measure at its place.
bool showsEvents(const TableColumn& column) {
  const auto& all = metrics::measureDefinitions();
  return std::any_of(all.begin(), all.end(), [&](const metrics::MeasureDefinition& definition) {
    return column.key == definition.place &&
           metrics::poolingOf(definition).kind == metrics::Pooling::kRate;
  });
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
                   const std::vector<BatchRun>& runs, RouteBootstrap& bootstrap) {
  Factors levels = row.levels;
  levels.insert(column.levels.begin(), column.levels.end());
  const auto own = runsWith(runs, levels);
  TableCell cell;
  if (index < row.paper.size()) cell.paper = row.paper[index];
  cell.runs = own.size();
  for (const BatchRun* run : own) cell.failed += !run->record.complete();
  const std::string weight = withSubject(column.weight, row.subject);
  if (!column.rift_key.empty())
    cell.rift = CellSums(own, column.rift_key, weight).overSeeds(bootstrap);
  const CellSums sums(own, withSubject(column.key, row.subject), weight);
  cell.seeds = showsEvents(column) ? sums.ofEvents(bootstrap, cell) : sums.overSeeds(bootstrap);
  cell.used = sums.used();
  cell.routes = sums.routes();
  if (!cell.seeds.mean) cell.note = reasonOf(levels, cell);
  return cell;
}

std::string csvLine(const Table& table, std::size_t row, std::size_t column, bool rift) {
  const TableCell& cell = table.cells[row][column];
  const Statistics& statistics = rift ? cell.rift : cell.seeds;
  const TableColumn& head = table.definition.columns[column];
  std::optional<double> low;
  std::optional<double> high;
  if (statistics.interval) {
    low = statistics.interval->low;
    high = statistics.interval->high;
  }
  const bool counted = !rift && cell.events.has_value();
  return core::csvRow({table.definition.rows[row].name, head.name, head.unit,
                       rift ? "rift_compat" : "clean", core::csvNumber(cell.paper.mean),
                       core::csvNumber(cell.paper.deviation), core::csvNumber(statistics.mean),
                       core::csvNumber(statistics.standard_deviation), core::csvNumber(low),
                       core::csvNumber(high), std::to_string(statistics.n),
                       std::to_string(cell.routes), counted ? std::to_string(*cell.events) : "",
                       counted ? core::csvNumber(cell.kilometres) : "", std::to_string(cell.runs),
                       std::to_string(cell.used), std::to_string(cell.failed),
                       statistics.mean     ? ""
                       : cell.note.empty() ? "no run has this measure"
                                           : cell.note});
}

std::string statisticsText(const Statistics& statistics) {
  const std::string plus_minus = " \xC2\xB1 ";
  std::string text = core::formatFixed(*statistics.mean, 2);
  if (statistics.standard_deviation)
    text += plus_minus + core::formatFixed(*statistics.standard_deviation, 2);
  return text + intervalText(statistics.interval, 2);
}

}  // namespace

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

std::string tableCsv(const Table& table) {
  std::string text =
      "row,column,unit,definition,paper_mean,paper_std,mean,std,interval_95_low,interval_95_high,"
      "seeds,routes,events,km,runs,runs_with_figure,runs_failed,note\n";
  for (std::size_t row = 0; row < table.cells.size(); ++row) {
    for (std::size_t column = 0; column < table.cells[row].size(); ++column) {
      text += csvLine(table, row, column, false);
      if (!table.definition.columns[column].rift_key.empty())
        text += csvLine(table, row, column, true);
    }
  }
  return text;
}

std::string cellText(const TableCell& cell) {
  if (!cell.seeds.mean) return "(" + cell.note + ")";
  const std::string events = cell.events ? std::to_string(*cell.events) + " / " +
                                               core::formatFixed(cell.kilometres, 3) + " km = "
                                         : std::string();
  return events + statisticsText(cell.seeds) + " (" + countText(cell.routes, "route") + ", " +
         countText(cell.seeds.n, "seed") + ", " + countText(cell.used, "run") +
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
