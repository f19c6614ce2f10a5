// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/paper/table_definitions.h"

#include <algorithm>
#include <iterator>

#include "evaluation/paper/paper_systems.h"
#include "evaluation/paper/paper_table.h"
#include "evaluation/paper/published_figures.h"
#include "metrics/known_measures.h"

namespace cdiff::evaluation {
namespace {

namespace known = metrics::known;

/// The n beside the mean of a distribution.
std::string countBeside(const metrics::MeasureDefinition& mean) {
  const std::string place = mean.place;
  return place.substr(0, place.rfind('/')) + "/n";
}

// Columns. 2D-TTC is weighted by its decisions, also RIFT's; rates are weighted by what they are
// rates of, so that they are the rate over all runs of a seed; others are means of the sessions'
// figures.

TableColumn timeToCollision() {
  return {"2D-TTC", "s", known::kTtcMean.place, countBeside(known::kTtcMean), known::kRiftTtc.place,
          {}};
}

TableColumn offRoadRate() {
  return {
      "ORR", "%", known::kCbvOffRoad.place, known::kCbvDecisions.place, known::kRiftOffRoad.place,
      {}};
}

std::vector<TableColumn> realism() {
  return {
      {"S-SW", "", known::kSpeedShapiroWilk.place, "", known::kRiftSpeedShapiroWilk.place, {}},
      {"A-SW",
       "",
       known::kAccelerationShapiroWilk.place,
       "",
       known::kRiftAccelerationShapiroWilk.place,
       {}},
      {"S-WD", "m/s", known::kSpeedWasserstein.place, "", known::kRiftSpeedWasserstein.place, {}}};
}

std::vector<TableColumn> controllabilityAndRealism() {
  std::vector<TableColumn> columns = {timeToCollision(), offRoadRate()};
  const std::vector<TableColumn> further = realism();
  columns.insert(columns.end(), further.begin(), further.end());
  return columns;
}

TableColumn drivingScore() { return {"DS", "", known::kDrivingScore.place, "", "", {}}; }

TableColumn routeCompletion() { return {"RC", "%", known::kRouteCompletion.place, "", "", {}}; }

TableRow cbvRow(const PaperSystem& system, std::vector<PaperFigure> paper) {
  return {system.name, cbvLevels(system), std::move(paper), ""};
}

/// What the paper prints for its own system stands beside both methods.
void addOwnRows(const std::vector<PaperFigure>& paper, TableDefinition& table) {
  for (const PaperSystem& own : {paper::kDiffusion, paper::kPaperMethod})
    table.rows.push_back(cbvRow(own, paper));
}

/// Adds what RIFT's repository prints beside the rows, which are those of the CBV planners, in
/// columns of these names under `ego`.
void addRepository(const PaperSystem& ego, const std::vector<TableColumn>& columns,
                   TableDefinition& table) {
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    for (const TableColumn& column : columns) {
      table.rows[i].repository.push_back(repositoryFigure(ego, paperCbvPlanners()[i], column.name));
    }
  }
}

/// The protocol of the published figures, then the differences of the systems.
std::vector<std::string> footnotesOf(const std::vector<PaperSystem>& systems) {
  std::vector<std::string> footnotes = {kPublishedProtocol};
  for (const std::string& line : systemDifferences(systems)) footnotes.push_back(line);
  return footnotes;
}

TableDefinition withLevels(TableDefinition table, const Factors& levels) {
  for (TableRow& row : table.rows) row.levels = merged(levels, row.levels);
  return table;
}

TableDefinition table1() {
  TableDefinition table = {
      "table_1",
      "Table 1. Controllability and realism under ego planner PDM-Lite",
      "",
      "CBV planner",
      controllabilityAndRealism(),
      {cbvRow(paper::kPpo, {{2.41, 1.52}, {8.82, 8.83}, {0.80, 0.01}, {0.65, 0.02}, {6.48, 0.10}}),
       cbvRow(paper::kPluto,
              {{2.56, 1.55}, {3.02, 3.09}, {0.84, 0.08}, {0.83, 0.12}, {6.13, 0.59}}),
       cbvRow(paper::kRift,
              {{2.70, 1.34}, {0.83, 0.33}, {0.97, 0.00}, {0.94, 0.03}, {4.26, 0.12}})}};
  addOwnRows({{2.79, 1.33}, {1.26, 1.47}, {0.97, 0.01}, {0.88, 0.09}, {4.80, 1.38}}, table);
  addRepository(paper::kPdmLite, table.columns, table);
  table.footnotes = footnotesOf({paper::kPdmLite, paper::kPpo, paper::kPluto, paper::kRift});
  return withLevels(table, egoLevel(paper::kPdmLite));
}

TableDefinition table2() {
  TableDefinition table = {
      "table_2",
      "Table 2. Controllability and realism under ego planner PlanT",
      "",
      "CBV planner",
      controllabilityAndRealism(),
      {cbvRow(paper::kPpo, {{2.04, 2.08}, {4.50, 1.15}, {0.93, 0.01}, {0.94, 0.02}, {5.02, 0.19}}),
       cbvRow(paper::kPluto,
              {{2.59, 1.88}, {6.44, 1.57}, {0.84, 0.02}, {0.78, 0.03}, {6.20, 0.23}}),
       cbvRow(paper::kRift,
              {{1.90, 0.36}, {0.38, 0.10}, {0.63, 0.03}, {0.49, 0.02}, {7.23, 0.08}})}};
  addOwnRows({{2.92, 1.53}, {5.96, 2.47}, {0.97, 0.03}, {0.94, 0.02}, {3.83, 0.73}}, table);
  addRepository(paper::kPlanT, table.columns, table);
  table.footnotes = footnotesOf({paper::kPlanT, paper::kPpo, paper::kPluto, paper::kRift});
  return withLevels(table, egoLevel(paper::kPlanT));
}

/// Mean and deviation of DS and RC under each ego planner of Table 3, in the order of its columns;
/// rows PPO, Pluto, RIFT, E2E-CDiff.
constexpr double kTable3[4][8][2] = {{{89.77, 5.18},
                                      {92.75, 3.45},
                                      {45.43, 2.10},
                                      {65.91, 0.72},
                                      {71.22, 4.61},
                                      {88.63, 1.10},
                                      {69.42, 4.43},
                                      {82.33, 1.61}},
                                     {{74.32, 6.33},
                                      {79.74, 3.51},
                                      {42.18, 2.75},
                                      {55.87, 4.07},
                                      {75.02, 2.79},
                                      {83.41, 2.69},
                                      {72.61, 4.11},
                                      {81.57, 1.47}},
                                     {{93.23, 2.19},
                                      {94.42, 1.61},
                                      {46.76, 2.01},
                                      {62.83, 4.08},
                                      {77.37, 2.01},
                                      {87.84, 4.08},
                                      {75.67, 1.80},
                                      {83.42, 0.39}},
                                     {{96.49, 0.10},
                                      {96.49, 0.10},
                                      {51.52, 6.12},
                                      {66.84, 1.62},
                                      {69.59, 1.95},
                                      {85.99, 4.71},
                                      {76.05, 1.59},
                                      {84.28, 0.21}}};

TableDefinition table3() {
  TableDefinition table = {
      "table_3",
      "Table 3. Safety-critical evaluation of driving systems under different CBV planners",
      "CBVs are driven naturalistically; the collision-seeking variant is Figure 4.",
      "CBV planner",
      {},
      {}};
  for (std::size_t i = 0; i < paperCbvPlanners().size(); ++i) {
    std::vector<PaperFigure> paper;
    const std::size_t printed = std::min(i, std::size(kTable3) - 1);
    for (const auto& figure : kTable3[printed]) paper.push_back({figure[0], figure[1]});
    table.rows.push_back(cbvRow(paperCbvPlanners()[i], paper));
  }
  for (const PaperSystem& ego : paperEgoPlanners()) {
    if (ego.planner() == paper::kDiffusion.planner()) continue;
    addRepository(ego, {drivingScore(), routeCompletion()}, table);
    for (TableColumn column : {drivingScore(), routeCompletion()}) {
      column.name = std::string(ego.name) + " " + column.name;
      column.levels = egoLevel(ego);
      table.columns.push_back(column);
    }
  }
  table.footnotes = footnotesOf({paper::kPdmLite, paper::kPlanT, paper::kUniAd, paper::kVad,
                                 paper::kPpo, paper::kPluto, paper::kRift});
  return table;
}

TableDefinition table4() {
  TableDefinition table = {"table_4",
                           "Table 4. Two-stage trajectory-then-PID against end-to-end control",
                           "Ego planner PDM-Lite; the two drive the CBVs with the same model. The "
                           "last row, which the paper does not have, is two-stage with a second "
                           "tracker: how far the comparison rests on one set of gains.",
                           "Execution",
                           {drivingScore(), routeCompletion(), timeToCollision(), offRoadRate()},
                           {}};
  const std::vector<PaperFigure> paper[] = {
      {{95.08, 2.48}, {96.41, 0.21}, {2.68, 1.27}, {6.22, 0.03}},
      {{96.49, 0.10}, {96.49, 0.10}, {2.94, 1.24}, {2.17, 1.47}}};
  for (std::size_t i = 0; i < paperExecutions().size(); ++i)
    table.rows.push_back(cbvRow(paperExecutions()[i], paper[i % std::size(paper)]));
  TableRow second = cbvRow(paper::kTwoStage, std::vector<PaperFigure>(table.columns.size()));
  second.name = "Two-stage trajectory-then-PID, PDM-Lite's tracker (method default)";
  second.levels["variant"] = kSecondTracker;
  table.rows.push_back(second);
  return withLevels(table, egoLevel(paper::kPdmLite));
}

/// Rows of Table 5: objectives, the profiles that hold them alone by method default and by method
/// paper, and what the paper prints.
struct AblationRow {
  const char* objectives;
  const char* default_profile;
  const char* paper_profile;
  std::vector<PaperFigure> paper;
};

const std::vector<AblationRow>& ablationRows() {
  static const std::vector<AblationRow> rows = {
      {"collision + drivable + speed",
       "ablation_all",
       "paper_naturalistic",
       {{2.79, 1.33}, {1.26, 1.47}, {0.97, 0.01}, {0.88, 0.09}, {4.80, 1.38}}},
      {"collision",
       "ablation_collision",
       "paper_ablation_collision",
       {{2.75, 1.41}, {7.05, 2.73}, {0.96, 0.01}, {0.90, 0.00}, {4.16, 0.02}}},
      {"drivable",
       "ablation_drivable",
       "paper_ablation_drivable",
       {{2.83, 1.20}, {3.50, 1.93}, {0.88, 0.03}, {0.77, 0.03}, {5.61, 0.38}}},
      {"speed",
       "ablation_speed",
       "paper_ablation_speed",
       {{2.79, 1.25}, {6.25, 2.11}, {0.89, 0.11}, {0.83, 0.13}, {5.11, 1.50}}},
      {"none",
       "none",
       "none",
       {{2.62, 1.28}, {7.31, 3.18}, {0.95, 0.01}, {0.89, 0.02}, {4.35, 0.24}}}};
  return rows;
}

TableDefinition table5() {
  TableDefinition table = {
      "table_5",
      "Table 5. Ablation of the guidance objectives",
      "Ego planner PDM-Lite, CBV planner E2E-CDiff. Rows are guidance profiles by both methods.",
      "Objectives",
      controllabilityAndRealism(),
      {}};
  for (const PaperSystem& own : {paper::kDiffusion, paper::kPaperMethod}) {
    const bool paper_method = own.method == std::string(paper::kPaperMethod.method);
    for (const AblationRow& row : ablationRows()) {
      Factors levels = cbvLevels(own);
      levels["guidance_profile"] = paper_method ? row.paper_profile : row.default_profile;
      table.rows.push_back(
          {std::string(row.objectives) + " (method " + own.method + ")", levels, row.paper, ""});
    }
  }
  return withLevels(table, egoLevel(paper::kPdmLite));
}

TableDefinition table6() {
  const std::vector<PaperFigure> paper[] = {{{95.61, 1.31}, {95.61, 1.31}},
                                            {{53.22, 1.69}, {70.55, 0.28}},
                                            {{76.14, 1.29}, {88.96, 0.63}},
                                            {{78.76, 2.14}, {83.03, 0.09}},
                                            {{79.96, 1.63}, {89.91, 3.76}}};
  TableDefinition table = {"table_6",
                           "Table 6. Ego planners",
                           "The paper does not say what drives the CBVs here; ours are driven by "
                           "PDM-Lite, so that the ego's planner alone is under test.",
                           "Ego planner",
                           {drivingScore(), routeCompletion()},
                           {}};
  for (std::size_t i = 0; i < paperEgoPlanners().size(); ++i) {
    const PaperSystem& ego = paperEgoPlanners()[i];
    const PaperSystem cbvs(paper::kPdmLite.title, paper::kPdmLite.name, ego.method);
    table.rows.push_back({ego.name, merged(egoLevel(ego), cbvLevels(cbvs)),
                          paper[std::min(i, std::size(paper) - 1)], ""});
  }
  table.footnotes = footnotesOf({paper::kPdmLite, paper::kPlanT, paper::kUniAd, paper::kVad});
  return table;
}

}  // namespace

std::vector<TableDefinition> paperTables() {
  return {table1(), table2(), table3(), table4(), table5(), table6()};
}

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
    table.footnotes.push_back("For other CBV planners under " + std::string(ego.name) +
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
