// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/heat_map.h"

#include <algorithm>
#include <map>

#include "core/text.h"
#include "evaluation/contact_counts.h"
#include "metrics/known_measures.h"
#include "page/page_parts.h"

namespace cdiff::evaluation {
namespace {

using core::element;
using core::Markup;

/// The runs of one scenario and one system.
struct HeatCell {
  std::size_t runs = 0;    ///< complete
  std::size_t others = 0;  ///< that are not
  ContactCounts contacts;  ///< of the ego
  double at_fault = 0.0;   ///< of these, the ego's fault
  double score = 0.0;      ///< sum of driving scores
};

using HeatRow = std::map<Factors, HeatCell>;

double measureOr0(const RunRecord& record, const metrics::MeasureDefinition& measure) {
  const auto found = record.measures.find(measure.name);
  return found == record.measures.end() ? 0.0 : found->second;
}

void addToCell(const RunRecord& record, HeatCell& cell) {
  if (!record.complete()) {
    ++cell.others;
    return;
  }
  ++cell.runs;
  cell.contacts += contactCountsOf(record);
  cell.at_fault += measureOr0(record, metrics::known::kContactsAtFault);
  cell.score += measureOr0(record, metrics::known::kDrivingScore);
}

/// Shade by contacts of the moving ego per run: none, up to a half, one, two, more.
std::string shadeOf(const HeatCell& cell) {
  const double per_run = cell.contacts.moving() / static_cast<double>(cell.runs);
  int shade = 0;
  for (const double limit : {0.0, 0.5, 1.0, 2.0}) shade += per_run > limit ? 1 : 0;
  return "h" + std::to_string(shade);
}

/// What a run's row in the table of runs says of its cell, by which a click filters.
std::string filterOf(const std::string& scenario, const std::string& system) {
  return scenario + " \u00b7 " + system;
}

Markup cellHtml(const HeatCell& cell, const std::string& filter) {
  if (cell.runs == 0) {
    const std::string text = cell.others == 0 ? "\u2013" : "not complete";
    return element("td", {{"class", "heat"}}, text);
  }
  const std::string score = core::formatFixed(cell.score / static_cast<double>(cell.runs), 0);
  const Markup link = element("a", {{"href", "#runs"}, {"data-filter", filter}},
                              element("b", {}, core::formatFixed(cell.contacts.all, 0)) +
                                  (cell.contacts.all == 1.0 ? " contact" : " contacts"));
  const std::string kinds = kindsText(cell.contacts);
  const std::string under =
      (kinds.empty() ? "" : kinds + "; ") + core::formatFixed(cell.at_fault, 0) +
      " at fault, score " + score + ", " + countText(cell.runs, "run") +
      (cell.others == 0 ? "" : ", " + std::to_string(cell.others) + " not complete");
  return element("td", {{"class", "heat " + shadeOf(cell)}}, link + element("small", {}, under));
}

double contactsIn(const HeatRow& row) {
  double sum = 0.0;
  for (const auto& [factors, cell] : row) sum += cell.contacts.moving();
  return sum;
}

/// Scenarios with their cells, most contacts of the moving ego first.
std::vector<std::pair<std::string, HeatRow>> heatRows(const std::vector<RunRecord>& records) {
  std::map<std::string, HeatRow> by_scenario;
  for (const RunRecord& record : records)
    addToCell(record, by_scenario[record.factors.at("scenario")][systemFactors(record.factors)]);
  std::vector<std::pair<std::string, HeatRow>> rows(by_scenario.begin(), by_scenario.end());
  std::stable_sort(rows.begin(), rows.end(), [](const auto& left, const auto& right) {
    return contactsIn(left.second) > contactsIn(right.second);
  });
  return rows;
}

}  // namespace

Markup heatMap(const std::vector<RunRecord>& records, const Ranking& ranking,
               const SystemNames& names) {
  Markup head = element("th", {{"scope", "col"}}, "Scenario");
  for (const System& system : ranking.systems)
    head += element("th", {{"scope", "col"}}, names.of(system.factors));
  Markup rows = "\n";
  for (const auto& [scenario, row] : heatRows(records)) {
    Markup cells = element("th", {{"scope", "row"}}, scenario);
    for (const System& system : ranking.systems) {
      const auto cell = row.find(system.factors);
      cells += cellHtml(cell == row.end() ? HeatCell() : cell->second,
                        filterOf(scenario, names.of(system.factors)));
    }
    rows += element("tr", {}, cells) + "\n";
  }
  const Markup table =
      element("table", {{"class", "heat-map"}},
              element("thead", {}, element("tr", {}, head)) + element("tbody", {}, rows));
  return element("div", {{"class", "scroll"}}, table) + "\n" +
         page::pageNote(
             "Contacts of the ego: with CBVs and with background traffic; the stronger the color, "
             "the more per run while the ego moves. Below: those at its fault, mean driving "
             "score. A click on a cell shows its runs.");
}

}  // namespace cdiff::evaluation
