// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/paper/findings.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

#include "core/text.h"
#include "evaluation/intervals/pooled_estimate.h"
#include "evaluation/paper/cell_sums.h"
#include "evaluation/paper/paper_systems.h"
#include "evaluation/paper/paper_table.h"
#include "evaluation/paper/table_definitions.h"

namespace cdiff::evaluation {
namespace {

/// A cell of a table: what the paper prints, and which runs are ours.
struct Side {
  std::string name;
  Factors levels;
  PaperFigure paper;
};

std::vector<std::uint32_t> placesOf(const CellSums& sums, const std::vector<std::string>& routes) {
  std::vector<std::uint32_t> places;
  for (const std::string& route : routes)
    places.push_back(static_cast<std::uint32_t>(sums.names().at(route)));
  return places;
}

std::vector<std::string> sharedRoutes(const CellSums& a, const CellSums& b) {
  std::vector<std::string> shared;
  for (const auto& [route, place] : a.names())
    if (b.names().count(route) > 0) shared.push_back(route);
  return shared;
}

/// Difference of the figure of a column and its interval, over the routes that both sides have.
void measure(const CellSums& a, const CellSums& b, const metrics::PoolingRule& rule,
             RouteBootstrap& bootstrap, Finding& finding) {
  const std::vector<std::string> routes = sharedRoutes(a, b);
  finding.routes = routes.size();
  if (routes.size() < 2) return;
  const std::vector<std::uint32_t> places_a = placesOf(a, routes);
  const std::vector<std::uint32_t> places_b = placesOf(b, routes);
  const auto difference = [&](const std::vector<std::uint32_t>& of_a,
                              const std::vector<std::uint32_t>& of_b) -> std::optional<double> {
    const auto value_a = a.figure(of_a, rule);
    const auto value_b = b.figure(of_b, rule);
    return value_a && value_b ? std::optional(*value_a - *value_b) : std::nullopt;
  };
  finding.difference = difference(places_a, places_b);
  finding.interval = bootstrap.interval(routes.size(), [&](const std::uint32_t* first) {
    std::vector<std::uint32_t> of_a;
    std::vector<std::uint32_t> of_b;
    for (std::size_t i = 0; i < routes.size(); ++i) {
      of_a.push_back(places_a[first[i]]);
      of_b.push_back(places_b[first[i]]);
    }
    return difference(of_a, of_b);
  });
  if (finding.difference)
    finding.outcome = outcomeOf(finding.paper_difference, *finding.difference, finding.interval);
}

/// Collects the findings of tables.
class Findings {
 public:
  explicit Findings(const std::vector<BatchRun>& runs) : runs_(runs) {}

  /// The own row against each other one, column by column.
  void addTable(const TableDefinition& table) {
    const TableRow* own = ownRow(table);
    if (own == nullptr) return;
    for (const TableRow& row : table.rows) {
      if (&row == own || !isComparable(row)) continue;
      for (std::size_t i = 0; i < table.columns.size(); ++i)
        add(table.id, table.columns[i], sideOf(*own, i, table), sideOf(row, i, table));
    }
  }

  /// Attack against naturalistic driving, of the paper's method.
  void addFigure4() {
    const TableDefinition figure = collisionFigure();
    const auto column = [&](const char* mode) {
      const Factors wanted = cbvLevels(paper::kPaperMethod, mode);
      return std::find_if(figure.columns.begin(), figure.columns.end(),
                          [&](const TableColumn& known) { return known.levels == wanted; });
    };
    const auto attack = column(kSafetyCritical);
    const auto naturalistic = column(kNaturalistic);
    const auto side = [&](auto chosen, const char* name) {
      const auto index = static_cast<std::size_t>(chosen - figure.columns.begin());
      Side made = sideOf(figure.rows.front(), index, figure);
      made.name = name;
      return made;
    };
    TableColumn contacts = *attack;
    contacts.name = "contacts of CBVs";
    add(figure.id, contacts, side(attack, "attack"), side(naturalistic, "naturalistic"));
  }

  std::vector<Finding> found;

 private:
  static std::string levelOf(const TableRow& row, const char* factor) {
    const auto level = row.levels.find(factor);
    return level == row.levels.end() ? "" : level->second;
  }

  /// Whether a row shows the paper's own system, as CBV planner or ego.
  static bool isOwn(const TableRow& row) {
    const std::string own = paper::kDiffusion.planner();
    const std::string two_stage = paper::kTwoStage.planner();
    const std::string cbv = levelOf(row, "cbv_planner");
    return cbv == own || cbv == two_stage || levelOf(row, "ego_planner") == own;
  }

  static bool isByMethodPaper(const TableRow& row) {
    return levelOf(row, "method") == paper::kPaperMethod.method;
  }

  static bool isComparable(const TableRow& row) { return !isOwn(row) || isByMethodPaper(row); }

  /// The first row of the paper's own system by method paper that is not two-stage.
  static const TableRow* ownRow(const TableDefinition& table) {
    for (const TableRow& row : table.rows) {
      if (isOwn(row) && isByMethodPaper(row) &&
          levelOf(row, "cbv_planner") != paper::kTwoStage.planner())
        return &row;
    }
    return nullptr;
  }

  static Side sideOf(const TableRow& row, std::size_t column, const TableDefinition& table) {
    return {row.name, merged(row.levels, table.columns[column].levels),
            column < row.paper.size() ? row.paper[column] : PaperFigure{}};
  }

  void add(const std::string& table, const TableColumn& column, const Side& a, const Side& b) {
    if (!a.paper.mean || !b.paper.mean || *a.paper.mean == *b.paper.mean) return;
    Finding finding;
    finding.table = table;
    finding.figure = column.name;
    finding.unit = column.unit;
    finding.a = a.name;
    finding.b = b.name;
    finding.paper_difference = *a.paper.mean - *b.paper.mean;
    const std::string& key = column.rift_key.empty() ? column.key : column.rift_key;
    measure(CellSums(runsOf(a.levels), key, column.weight),
            CellSums(runsOf(b.levels), key, column.weight), poolingAt(key), bootstrap_, finding);
    found.push_back(finding);
  }

  std::vector<const BatchRun*> runsOf(Factors levels) const {
    levels.emplace("variant", variant_);
    return runsWith(runs_, levels);
  }

  const std::vector<BatchRun>& runs_;
  std::string variant_ = pooledVariant(runs_);
  RouteBootstrap bootstrap_;
};

std::string lineOf(const Finding& finding) {
  const std::string ours = finding.difference ? core::formatFixed(*finding.difference, 2) +
                                                    intervalText(finding.interval, 2)
                                              : "-";
  return "| " + finding.table + " | " + finding.figure + " | " + finding.a + " | " + finding.b +
         " | " + core::formatFixed(finding.paper_difference, 2) + " | " + ours + " | " +
         std::to_string(finding.routes) + " | " + toText(finding.outcome) + " |\n";
}

}  // namespace

const char* toText(FindingOutcome outcome) {
  switch (outcome) {
    case FindingOutcome::kReproduced:
      return "reproduced";
    case FindingOutcome::kNotReproduced:
      return "not reproduced";
    case FindingOutcome::kCannotBeTold:
      return "cannot be told";
    case FindingOutcome::kNotRun:
      break;
  }
  return "not run";
}

FindingOutcome outcomeOf(double paper_difference, double difference,
                         const std::optional<Interval>& interval) {
  if (!interval) return FindingOutcome::kCannotBeTold;
  const double sign = paper_difference < 0.0 ? -1.0 : 1.0;
  const double half = std::abs(paper_difference) / 2.0;
  const double least = sign > 0.0 ? interval->low : -interval->high;
  const double most = sign > 0.0 ? interval->high : -interval->low;
  if (least > 0.0 && sign * difference >= half) return FindingOutcome::kReproduced;
  if (most < half) return FindingOutcome::kNotReproduced;
  return FindingOutcome::kCannotBeTold;
}

std::vector<Finding> findingsOf(const std::vector<BatchRun>& runs) {
  Findings findings(runs);
  for (const TableDefinition& table : paperTables()) findings.addTable(table);
  findings.addFigure4();
  return findings.found;
}

std::string findingsMarkdown(const std::vector<Finding>& findings) {
  std::string text =
      "Rule: *reproduced* where the 95 % interval of our difference excludes 0 and the difference "
      "has the paper's sign and at least half of its size; *not reproduced* where the whole "
      "interval lies short of half the paper's size; else it *cannot be told*.\n\n"
      "| table | figure | A | B | the paper's A - B | ours | routes | outcome |\n"
      "|---|---|---|---|---|---|---|---|\n";
  std::map<FindingOutcome, int> counts;
  for (const Finding& finding : findings) {
    text += lineOf(finding);
    ++counts[finding.outcome];
  }
  std::vector<std::string> sums;
  for (const auto& [outcome, count] : counts)
    sums.push_back(std::to_string(count) + " " + toText(outcome));
  return text + "\n" + std::to_string(findings.size()) +
         " differences: " + core::joinText(sums, ", ") + ".\n";
}

}  // namespace cdiff::evaluation
