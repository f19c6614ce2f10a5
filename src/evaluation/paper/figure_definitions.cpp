// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <algorithm>
#include <iterator>

#include "evaluation/paper/paper_table.h"
#include "evaluation/paper/published_figures.h"
#include "metrics/known_measures.h"

namespace cdiff::evaluation {
namespace {

/// Contacts of CBVs with anyone, with what RIFT's code counts of them.
TableColumn allContacts() {
  return {"",
          "1/km",
          metrics::known::kCollisionsPerKm.place,
          metrics::known::kCbvDistance.place,
          metrics::known::kRiftCollisionsPerKm.place,
          {},
          "contacts of CBVs with anyone"};
}

/// Those with the ego alone, which the paper does not print.
TableColumn contactsWithTheEgo() {
  return {", contacts with the ego",          "1/km", metrics::known::kCbvEgoCollisionsPerKm.place,
          metrics::known::kCbvDistance.place, "",     {},
          "contacts of CBVs with the ego"};
}

/// One column for each method and mode of the paper's own system, named after them and `measure`.
void addModes(const TableColumn& measure, TableDefinition& table) {
  for (const PaperSystem& own : {paper::kDiffusion, paper::kPaperMethod}) {
    for (const char* mode : {kNaturalistic, kSafetyCritical}) {
      TableColumn column = measure;
      column.name = std::string("E2E-CDiff") + (mode == kSafetyCritical ? " w/ coll" : "") +
                    " (method " + own.method + ")" + measure.name;
      column.levels = cbvLevels(own, mode);
      table.columns.push_back(column);
    }
  }
}

/// Rows of the CBV planners, of which the paper prints none.
void addCbvLatencies(TableDefinition& table) {
  std::vector<PaperSystem> cbvs = {paper::kPpo, paper::kPluto, paper::kRift};
  cbvs.insert(cbvs.end(), paperExecutions().begin(), paperExecutions().end());
  for (const PaperSystem& cbv : cbvs) {
    const Factors levels = {{"cbv_planner", cbv.planner()}, {"method", cbv.method}};
    table.rows.push_back(
        {"CBV: " + std::string(cbv.name), levels, {}, "cbv:" + std::string(cbv.planner())});
  }
}

}  // namespace

TableDefinition collisionFigure() {
  TableDefinition table = {
      "figure_4",
      "Figure 4. Collisions of CBVs per km without and with collision-seeking "
      "guidance",
      "The paper prints the values of PDM-Lite alone, in its text, and none of contacts with the "
      "ego. What the two columns of a method differ in besides the objectives stands in the "
      "settings of its runs.",
      "Ego planner",
      {},
      {}};
  addModes(allContacts(), table);
  addModes(contactsWithTheEgo(), table);
  for (const PaperSystem& ego : paperEgoPlanners()) {
    if (ego.planner() == paper::kDiffusion.planner()) continue;
    table.rows.push_back({ego.name, egoLevel(ego), {}, ""});
  }
  table.rows.front().paper = {{5.68, {}}, {20.77, {}}, {5.68, {}}, {20.77, {}}};
  table.footnotes = systemDifferences({paper::kPlanT});
  for (const PaperSystem& ego : {paper::kPdmLite, paper::kPlanT}) {
    table.footnotes.push_back("Of other CBV planners under " + std::string(ego.name) +
                              " RIFT's repository prints " + repositoryList(ego, "CPK", "per km") +
                              ".");
  }
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
      "by decisions. Hardware and sizes of the networks are not the paper's.",
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
  addCbvLatencies(table);
  return table;
}

}  // namespace cdiff::evaluation
