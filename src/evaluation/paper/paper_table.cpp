// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/paper/paper_table.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "core/csv.h"
#include "core/text.h"
#include "evaluation/intervals/intervals.h"
#include "evaluation/intervals/pooled_estimate.h"
#include "metrics/metric_registry.h"
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

namespace {

std::string withSubject(std::string key, const std::string& subject) {
  const std::size_t place = key.find("{}");
  return place == std::string::npos ? key : key.replace(place, 2, subject);
}

/// What the runs of a cell add to a figure, by route and seed.
class CellSums {
 public:
  /// Complete runs that have `key`; those of weight 0 are skipped.
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

  /// Mean and deviation over seeds of the weighted means within them; interval by routes, of a
  /// bounded figure that is the same on all of them by those that were not seen.
  Statistics overSeeds(RouteBootstrap& bootstrap, const metrics::PoolingRule& rule) const {
    Statistics statistics = statisticsOf(seedMeans(allRoutes()));
    statistics.interval = bootstrap.interval(routes(), [&](const std::uint32_t* first) {
      return statisticsOf(seedMeans({first, first + routes()})).mean;
    });
    const bool bounded = std::isfinite(rule.least) && std::isfinite(rule.most);
    if (!statistics.interval && bounded && routes() > 1)
      statistics.interval = unseenInterval(*statistics.mean, rule.least, rule.most, routes());
    return statistics;
  }

  /// The same of events per km, where weights are meters; counts go to the cell.
  Statistics ofEvents(RouteBootstrap& bootstrap, TableCell& cell) const {
    Statistics statistics = statisticsOf(seedMeans(allRoutes()));
    cell.events = static_cast<std::size_t>(std::llround(events_));
    cell.kilometers = kilometers_;
    statistics.interval = std::nullopt;
    if (used_ == 0) return statistics;
    statistics.mean = events_ / kilometers_;
    statistics.interval =
        rateInterval(*cell.events, kilometers_, bootstrap.valueInterval(perKilometer()));
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
    kilometers_ += share / 1000.0;
    ++used_;
  }

  /// Events and km of each route.
  RouteSums perKilometer() const {
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
  double events_ = 0.0;  ///< where values are per km and weights meters
  double kilometers_ = 0.0;
};

/// The rule of the measure at a place of summary.json; a plain mean where there is none.
metrics::PoolingRule ruleAt(const std::string& place) {
  const auto& all = metrics::measureDefinitions();
  const auto found = std::find_if(
      all.begin(), all.end(), [&](const auto& definition) { return place == definition.place; });
  return found == all.end() ? metrics::kPlainMean : metrics::poolingOf(*found);
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

TableCell fillCell(const TableRow& row, std::size_t index, const TableColumn& column,
                   const std::vector<BatchRun>& runs, RouteBootstrap& bootstrap) {
  Factors levels = row.levels;
  levels.insert(column.levels.begin(), column.levels.end());
  const auto own = runsWith(runs, levels);
  TableCell cell;
  if (index < row.paper.size()) cell.paper = row.paper[index];
  if (index < row.repository.size()) cell.repository = row.repository[index];
  cell.runs = own.size();
  for (const BatchRun* run : own) {
    cell.failed += run->record.failed();
    cell.missing += !run->record.complete() && !run->record.failed();
  }
  const std::string weight = withSubject(column.weight, row.subject);
  if (!column.rift_key.empty())
    cell.rift =
        CellSums(own, column.rift_key, weight).overSeeds(bootstrap, ruleAt(column.rift_key));
  const CellSums sums(own, withSubject(column.key, row.subject), weight);
  const metrics::PoolingRule rule = ruleAt(column.key);
  cell.seeds = rule.kind == metrics::Pooling::kRate ? sums.ofEvents(bootstrap, cell)
                                                    : sums.overSeeds(bootstrap, rule);
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
