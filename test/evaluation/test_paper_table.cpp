// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <set>

#include "evaluation/batch_report.h"
#include "evaluation/paper/bar_figure.h"
#include "evaluation/paper/paper_figures.h"
#include "evaluation/paper/paper_systems.h"
#include "evaluation/paper/paper_table.h"
#include "evaluation/paper/table_definitions.h"
#include "evaluation/run_records.h"

namespace cdiff::evaluation {
namespace {

BatchRun runOf(const std::string& seed, const SummaryNumbers& numbers,
               const std::string& scenario = "s") {
  BatchRun run;
  run.record = test::recordWith({scenario, seed, "naturalistic"}, 1.0);
  run.numbers = numbers;
  return run;
}

/// One row of runs with PDM-Lite as CBV planner: the rate /r weighted by /w, RIFT's /x.
TableDefinition rateTable(const std::string& planner) {
  return {"table_9",
          "A rate",
          "",
          "System",
          {{"rate", "1/km", "/r", "/w", "/x", {}}},
          {{"ours", {{"cbv_planner", planner}}, {{5.0, 0.5}}, ""}}};
}

TEST(PaperTable, PoolsRatesWithinASeedAndSumsUpOverSeeds) {
  // Seed 1: (2 x 10 + 6 x 30) / 40 = 5; seed 2: 9. Mean 7, s = sqrt(8).
  // Routes drawn: a twice 2 and 9, mean 5.5; b twice 6; both 7: interval 5.5 to 7.
  const std::vector<BatchRun> runs = {
      runOf("1", {{"/r", 2.0}, {"/w", 10.0}}, "a"), runOf("1", {{"/r", 6.0}, {"/w", 30.0}}, "b"),
      runOf("2", {{"/r", 9.0}, {"/w", 1.0}, {"/x", 4.0}}, "a"), runOf("2", {}, "b")};
  const TableCell cell = fillTable(rateTable("pdm_lite"), runs).cells[0][0];
  EXPECT_EQ(cell.seeds.n, 2U);
  EXPECT_DOUBLE_EQ(*cell.seeds.mean, 7.0);
  EXPECT_NEAR(*cell.seeds.standard_deviation, 2.8284271, 1e-6);
  EXPECT_DOUBLE_EQ(cell.seeds.interval->low, 5.5);
  EXPECT_DOUBLE_EQ(cell.seeds.interval->high, 7.0);
  EXPECT_EQ(cell.routes, 2U);
  EXPECT_EQ(cell.runs, 4U);
  EXPECT_EQ(cell.used, 3U);
  EXPECT_DOUBLE_EQ(*cell.rift.mean, 4.0);
  EXPECT_EQ(cell.rift.n, 1U);
  EXPECT_EQ(cell.note, "");
}

TEST(PaperTable, PrintsEventsPerKilometerBesideTheirKilometers) {
  // 4 per km on 500 m and 2 per km on 1500 m: 2 + 3 contacts in 2 km; Garwood 1.6235 to 11.6683.
  TableDefinition table = rateTable("pdm_lite");
  table.columns = {{"CPK", "1/km", "/cbv/collisions_per_km", "/cbv/distance_m", "", {}}};
  const TableCell cell =
      fillTable(table,
                {runOf("1", {{"/cbv/collisions_per_km", 4.0}, {"/cbv/distance_m", 500.0}}, "a"),
                 runOf("1", {{"/cbv/collisions_per_km", 2.0}, {"/cbv/distance_m", 1500.0}}, "b")})
          .cells[0][0];
  EXPECT_EQ(*cell.events, 5U);
  EXPECT_DOUBLE_EQ(cell.kilometers, 2.0);
  EXPECT_DOUBLE_EQ(*cell.seeds.mean, 2.5);
  EXPECT_EQ(cellText(cell, false), "5 / 2.000 km = 2.50 (2 routes, 1 seed, 2 runs)");
  EXPECT_EQ(cellText(cell, true), "5 / 2.000 km = 2.50 [0.81, 5.83] (2 routes, 1 seed, 2 runs)");
}

TEST(PaperTable, SaysWhyACellIsEmpty) {
  const auto note = [](const std::string& planner, const std::vector<BatchRun>& runs) {
    return fillTable(rateTable(planner), runs).cells[0][0].note;
  };
  BatchRun broken = runOf("1", {});
  broken.record.status = "error";
  EXPECT_EQ(note("no_such_planner", {}), "not implemented");
  EXPECT_EQ(note("pdm_lite", {}), "not run");
  EXPECT_EQ(note("pdm_lite", {broken}), "no run completed");
  EXPECT_EQ(note("pdm_lite", {runOf("1", {})}), "no run has this measure");
  EXPECT_EQ(note("pdm_lite", {runOf("1", {{"/r", 1.0}, {"/w", 1.0}}), broken}), "");
}

TEST(PaperTable, TellsBrokenRunsFromThoseThatWereNotRun) {
  std::vector<BatchRun> runs(4, runOf("1", {}));
  runs[0] = runOf("1", {{"/r", 1.0}, {"/w", 1.0}});
  runs[1].record.status = "error";
  runs[2].record.status = "not_run";
  runs[3].record.status = "interrupted";
  const TableCell cell = fillTable(rateTable("pdm_lite"), runs).cells[0][0];
  EXPECT_EQ(cellText(cell, false), "1.00 (1 route, 1 seed, 1 run, 1 failed, 2 not run)");
}

TEST(PaperTable, SaysInWhichModeACellIsNotApplicable) {
  TableDefinition table = rateTable("pdm_lite");
  table.rows[0].levels["mode"] = "safety_critical";
  table.rows[0].levels["guidance_profile"] = "safety_critical";
  const auto note = [&](const std::vector<BatchRun>& runs) {
    return fillTable(table, runs).cells[0][0].note;
  };
  BatchRun natural = runOf("1", {{"/r", 1.0}, {"/w", 1.0}});
  BatchRun attack = natural;  // with another profile than the row's
  attack.record.factors["mode"] = "safety_critical";
  EXPECT_EQ(note({natural}), "not applicable in mode naturalistic");
  EXPECT_EQ(note({natural, attack}), "not run");
  natural.record.factors["cbv_planner"] = "diffusion";
  EXPECT_EQ(note({natural}), "not run");
  EXPECT_NE(tablesMarkdown({fillTable(table, {runOf("1", {})})})
                .find("| ours | (not applicable in mode naturalistic)<br>paper: 5.00"),
            std::string::npos);
}

TEST(PaperTable, ARowShowsAllIntervalsOrNone) {
  // Rate 2 on 5 routes, twice as much on the last; the second column has it on 4 of them.
  TableDefinition table = rateTable("pdm_lite");
  table.columns.push_back({"share", "%", "/cbv/off_road_rate_percent", "", "", {}});
  std::vector<BatchRun> runs;
  for (const char* route : {"a", "b", "c", "d", "e"}) {
    runs.push_back(runOf("1", {{"/r", *route == 'e' ? 4.0 : 2.0}, {"/w", 1.0}}, route));
    runs.back().numbers["/cbv/off_road_rate_percent"] = 0.0;
  }
  Table filled = fillTable(table, runs);
  EXPECT_TRUE(showsIntervals(filled.cells[0]));
  // 0 % on 5 routes: up to 1 - 0.025^(1/5) = 52.18 % of the routes may differ.
  EXPECT_EQ(cellText(filled.cells[0][1], true), "0.00 [0.00, 52.18] (5 routes, 1 seed, 5 runs)");
  std::string text = tablesMarkdown({filled});
  EXPECT_NE(text.find("[95 % interval"), std::string::npos);
  EXPECT_NE(text.find("2.40 [2.00, "), std::string::npos) << text;
  EXPECT_EQ(text.find("A row shows"), std::string::npos);
  runs.back().numbers.erase("/cbv/off_road_rate_percent");
  filled = fillTable(table, runs);
  text = tablesMarkdown({filled});
  EXPECT_FALSE(anyIntervals(filled));
  EXPECT_EQ(text.find("[95 %"), std::string::npos);
  EXPECT_NE(text.find("| 2.40 (5 routes, 1 seed, 5 runs)"), std::string::npos) << text;
  EXPECT_NE(text.find("A row shows the intervals of all its figures or none"), std::string::npos);
}

/// A run of E2E-CDiff against PDM-Lite on 1 km as CBV.
BatchRun ownRun(const char* mode, const std::string& conditioning, double contacts,
                double with_ego) {
  BatchRun run = runOf("1", {{"/cbv/distance_m", 1000.0},
                             {"/cbv/collisions_per_km", contacts},
                             {"/cbv/collisions_with_ego_per_km", with_ego}});
  for (const auto& [factor, level] : cbvLevels(paper::kDiffusion, mode))
    run.record.factors[factor] = level;
  run.cbv_conditioning = conditioning;
  return run;
}

TEST(PaperFigures, OfCollisionsShowsThoseWithTheEgoAndSaysWhereConditioningDiffers) {
  const Figure figure = barFigure(
      collisionFigure(),
      {ownRun(kNaturalistic, "image_route", 3.0, 1.0), ownRun(kSafetyCritical, "image", 9.0, 7.0)});
  ASSERT_EQ(figure.sheet.rows.size(), 2U);
  EXPECT_EQ(figure.sheet.rows[1][0].title, "contacts of CBVs with the ego");
  const std::string row = "PDM-Lite,\"E2E-CDiff w/ coll (method default), contacts with the ego\"";
  EXPECT_NE(figure.csv.find(row + ",1/km,clean,,,,,7,"), std::string::npos) << figure.csv;
  EXPECT_EQ(figure.sheet.notes.back(),
            "The columns differ in conditioning, too (what the network of the CBVs is given): "
            "E2E-CDiff (method default) image_route; E2E-CDiff w/ coll (method default) image.");
  EXPECT_EQ(figure.sheet.notes[1].find(';'), std::string::npos);  // no cell: one reason for all
  const Figure same = barFigure(collisionFigure(), {ownRun(kNaturalistic, "image", 3.0, 1.0),
                                                    ownRun(kSafetyCritical, "image", 9.0, 7.0)});
  EXPECT_EQ(same.sheet.notes.back().find("conditioning"), std::string::npos);
}

TEST(PaperTable, CsvHoldsThePublishedValuesBesideOurs) {
  TableDefinition table = rateTable("pdm_lite");
  table.rows[0].repository = {{6.0, 0.25}};
  const std::string csv = tableCsv(fillTable(table, {runOf("1", {{"/r", 2.0}, {"/w", 10.0}})}));
  EXPECT_EQ(csv,
            "row,column,unit,definition,paper_mean,paper_std,rift_repository_mean,"
            "rift_repository_std,mean,std,interval_95_low,interval_95_high,seeds,routes,events,km,"
            "runs,runs_with_figure,runs_failed,runs_not_run,note\n"
            "ours,rate,1/km,clean,5,0.5,6,0.25,2,,,,1,1,,,1,1,0,0,\n"
            "ours,rate,1/km,rift_compat,5,0.5,6,0.25,,,,,0,0,,,1,0,0,0,no run has this measure\n");
}

TEST(PaperTable, NamesTheSubjectInAKey) {
  TableDefinition table = rateTable("pdm_lite");
  table.columns = {{"p50", "ms", "/latency/{}/p50", "", "", {}}};
  table.rows[0].subject = "ego:pdm_lite";
  const TableCell cell =
      fillTable(table, {runOf("1", {{"/latency/ego:pdm_lite/p50", 3.0}})}).cells[0][0];
  EXPECT_DOUBLE_EQ(*cell.seeds.mean, 3.0);
}

TEST(PaperDefinitions, HaveAPaperFigureForEveryCellOfTheTables) {
  std::set<std::string> ids;
  for (const TableDefinition& table : paperTables()) {
    ids.insert(table.id);
    EXPECT_GE(table.rows.size(), 2U);
    for (const TableRow& row : table.rows) {
      EXPECT_EQ(row.paper.size(), table.columns.size()) << table.id << " " << row.name;
    }
  }
  EXPECT_EQ(ids.size(), 6U);
  EXPECT_EQ(latencyFigure().rows[4].paper[0].mean, 856.66);
  EXPECT_EQ(collisionFigure().rows[0].paper[1].mean, 20.77);
}

TEST(PaperDefinitions, SelectByFactorsThatExist) {
  const auto& known = factorNames();
  for (const TableDefinition& table : paperTables()) {
    for (const TableRow& row : table.rows) {
      for (const auto& [factor, level] : row.levels)
        EXPECT_NE(std::find(known.begin(), known.end(), factor), known.end()) << factor;
    }
  }
}

TEST(SummaryNumbers, AreFoundByJsonPointer) {
  const SummaryNumbers numbers =
      summaryNumbers(R"({"a": {"b:c": {"d": 1.5}, "n": null}, "list": [1], "e": 2})", "x");
  EXPECT_EQ(numbers, (SummaryNumbers{{"/a/b:c/d", 1.5}, {"/e", 2.0}}));
}

}  // namespace
}  // namespace cdiff::evaluation
