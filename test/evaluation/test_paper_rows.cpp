// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Each row and cell of the paper's tables and figures: which runs fill it, what stands beside it,
/// and that evaluation paper_tables has its runs.
#include <gtest/gtest.h>

#include <algorithm>

#include "evaluation/batch_report.h"
#include "evaluation/matrix.h"
#include "evaluation/paper/bar_figure.h"
#include "evaluation/paper/paper_figures.h"
#include "evaluation/paper/paper_systems.h"
#include "evaluation/paper/paper_table.h"
#include "evaluation/paper/published_figures.h"
#include "evaluation/paper/table_definitions.h"
#include "evaluation/run_records.h"
#include "session/session_request.h"

namespace cdiff::evaluation {
namespace {

/// The levels of the runs of a cell.
Factors cellLevels(const TableRow& row, const TableColumn& column) {
  return merged(row.levels, column.levels);
}

/// Calls `visit(table, row, column)` for each cell of the six tables and of Figures 4 and 8.
template <class Visit>
void forEachCell(const Visit& visit) {
  std::vector<TableDefinition> tables = paperTables();
  tables.push_back(collisionFigure());
  tables.push_back(latencyFigure());
  for (const TableDefinition& table : tables) {
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
      for (std::size_t column = 0; column < table.columns.size(); ++column)
        visit(table, row, column);
    }
  }
}

std::string withSubject(std::string key, const std::string& subject) {
  const std::size_t place = key.find("{}");
  return place == std::string::npos ? key : key.replace(place, 2, subject);
}

/// A run at the levels of a cell in which its measure is 2 (per km: on 1 km).
BatchRun runFor(const TableRow& row, const TableColumn& column) {
  BatchRun run;
  run.record = test::recordWith({"s", "1"}, 1.0);
  for (const auto& [factor, level] : cellLevels(row, column)) run.record.factors[factor] = level;
  if (!column.weight.empty()) run.numbers[withSubject(column.weight, row.subject)] = 1000.0;
  run.numbers[withSubject(column.key, row.subject)] = 2.0;
  return run;
}

TEST(PaperRows, EachCellIsFilledByRunsOfItsPlanners) {
  std::size_t filled = 0;
  forEachCell([&](const TableDefinition& table, std::size_t row, std::size_t column) {
    const BatchRun run = runFor(table.rows[row], table.columns[column]);
    const TableCell cell = fillTable(table, {run}).cells[row][column];
    ASSERT_TRUE(cell.seeds.mean) << table.id << " " << table.rows[row].name << ": " << cell.note;
    EXPECT_DOUBLE_EQ(*cell.seeds.mean, 2.0) << table.id << " " << table.rows[row].name;
    ++filled;
  });
  // Tables: 25 + 25 + 5 x 8 + 20 + 50 + 12; Figure 4: 4 egos x 8; Figure 8: (6 egos + 7) x 2.
  EXPECT_EQ(filled, 172U + 32U + 26U);
}

// The paper's own cells, without the rows of method paper beside them.
TEST(PaperRows, NoneOfThe115CellsWaitsForASystem) {
  std::size_t cells = 0;
  for (const TableDefinition& table : paperTables()) {
    const Table empty = fillTable(table, {});
    for (std::size_t row = 0; row < empty.cells.size(); ++row) {
      for (const TableCell& cell : empty.cells[row]) {
        EXPECT_EQ(cell.note, "not run") << table.id << " " << table.rows[row].name;
        const auto& levels = table.rows[row].levels;
        const auto method = levels.find("method");
        cells +=
            cell.paper.mean.has_value() && (method == levels.end() || method->second != "paper");
      }
    }
  }
  EXPECT_EQ(cells, 115U);
}

TEST(PaperRows, MiniaturesStandBesideWhatIsPublishedOfTheLargeOnes) {
  const std::string text = tablesMarkdown({fillTable(paperTables()[5], {})});
  EXPECT_NE(text.find("| UniAD mini | (not run)<br>paper: 76.14 ± 1.29"), std::string::npos)
      << text;
  EXPECT_NE(text.find("\n- VAD mini: published: Bench2Drive's checkpoint"), std::string::npos)
      << text;
  EXPECT_NE(barFigure(latencyFigure(), {})
                .csv.find("\nVAD mini,p50,ms,clean,379.5,,,,,,,,0,0,,,0,0,0,0,"
                          "not run\n"),
            std::string::npos);
}

/// The levels of a combination, its profile as its method names it.
Factors levelsOf(const Combination& combination) {
  const std::string& profile = combination.guidance_profile;
  return {{"ego_planner", combination.ego_planner},
          {"cbv_planner", combination.cbv_planner},
          {"mode", combination.mode},
          {"method", combination.method},
          {"guidance_profile",
           profile.empty() ? session::loadMethod(combination.method).profileOf(combination.mode)
                           : profile},
          {"variant", combination.variant}};
}

bool contains(const Factors& levels, const Factors& wanted) {
  return std::all_of(wanted.begin(), wanted.end(),
                     [&](const auto& level) { return levels.at(level.first) == level.second; });
}

class PaperTablesMatrix : public testing::Test {
 protected:
  PaperTablesMatrix() {
    const MatrixOptions matrix = loadMatrix("paper_tables");
    for (const Combination& combination : combinationsOf(matrix, "paper_tables"))
      levels_.push_back(levelsOf(combination));
  }
  std::vector<Factors> levels_;
};

TEST_F(PaperTablesMatrix, HasRunsForEachCell) {
  forEachCell([&](const TableDefinition& table, std::size_t row, std::size_t column) {
    const Factors wanted = cellLevels(table.rows[row], table.columns[column]);
    EXPECT_TRUE(std::any_of(levels_.begin(), levels_.end(),
                            [&](const Factors& levels) { return contains(levels, wanted); }))
        << table.id << " " << table.rows[row].name << " " << table.columns[column].name;
  });
}

// Figure 8 takes any run of a planner, so it asks for none of its own.
TEST_F(PaperTablesMatrix, HasNoCombinationWithoutACellNorTwice) {
  for (std::size_t i = 0; i < levels_.size(); ++i) {
    bool shown = false;
    forEachCell([&](const TableDefinition& table, std::size_t row, std::size_t column) {
      shown |= table.id != "figure_8" &&
               contains(levels_[i], cellLevels(table.rows[row], table.columns[column]));
    });
    EXPECT_TRUE(shown) << "combination " << i + 1;
    EXPECT_EQ(std::count(levels_.begin(), levels_.end(), levels_[i]), 1) << "combination " << i + 1;
  }
  EXPECT_EQ(levels_.size(), 46U);
}

/// The cell of a row in a column of a table without runs.
TableCell cellOf(std::size_t table, const char* row, const std::string& column) {
  const TableDefinition definition = paperTables()[table];
  const Table empty = fillTable(definition, {});
  for (std::size_t i = 0; i < definition.rows.size(); ++i) {
    for (std::size_t j = 0; j < definition.columns.size(); ++j) {
      if (definition.rows[i].name == row && definition.columns[j].name == column)
        return empty.cells[i][j];
    }
  }
  ADD_FAILURE() << row << " " << column;
  return {};
}

TEST(RiftsRepository, StandsBesideThePaperWhereItPrintsAFigure) {
  EXPECT_EQ(paperText(cellOf(0, "PPO", "ORR").paper), "8.82 ± 8.83");
  EXPECT_EQ(paperText(cellOf(0, "PPO", "ORR").repository), "9.17 ± 2.39");
  EXPECT_EQ(paperText(cellOf(0, "RIFT", "S-WD").repository), "4.46 ± 0.43");
  EXPECT_EQ(paperText(cellOf(1, "RIFT", "S-WD").repository), "4.58 ± 0.19");
  EXPECT_EQ(paperText(cellOf(1, "PPO", "A-SW").repository), "0.92");
  EXPECT_EQ(paperText(cellOf(2, "Pluto", "PDM-Lite RC").repository), "81.84 ± 2.20");
  EXPECT_EQ(paperText(cellOf(2, "RIFT", "PlanT DS").repository), "44.28 ± 3.15");
  EXPECT_FALSE(cellOf(2, "RIFT", "UniAD mini DS").repository.mean);
  EXPECT_FALSE(cellOf(0, paper::kDiffusion.name, "ORR").repository.mean);
  EXPECT_FALSE(cellOf(5, "PDM-Lite", "DS").repository.mean);
  EXPECT_EQ(repositoryList(paper::kPdmLite, "CPK", "per km"),
            "PPO 13.95 ± 2.34, Pluto 5.06 ± 2.69, RIFT 6.83 ± 2.62 per km");
  const std::string text = tablesMarkdown({fillTable(paperTables()[0], {})});
  EXPECT_NE(text.find("| (not run)<br>paper: 8.82 ± 8.83<br>RIFT's repository: 9.17 ± 2.39 |"),
            std::string::npos)
      << text;
}

TEST(RiftsRepository, PrintsAllCellsOfItsThreePlannersUnderItsTwoEgos) {
  std::vector<std::size_t> counts;
  for (const TableDefinition& table : paperTables()) {
    counts.push_back(0);
    for (const TableRow& row : table.rows) {
      for (const PaperFigure& figure : row.repository) counts.back() += figure.mean.has_value();
    }
  }
  EXPECT_EQ(counts, (std::vector<std::size_t>{3 * 5, 3 * 5, 3 * 4, 0, 0, 0}));
}

bool anyStartsWith(const std::vector<std::string>& lines, const std::string& start) {
  return std::any_of(lines.begin(), lines.end(),
                     [&](const std::string& line) { return line.rfind(start, 0) == 0; });
}

TEST(Footnotes, NameWhatDiffersOfEachSystemThatATableCompares) {
  const auto tables = paperTables();
  for (const std::size_t table : {0U, 1U, 2U}) {
    for (const char* cbv : {"PPO: published: ", "Pluto: published: ", "RIFT: published: "})
      EXPECT_TRUE(anyStartsWith(tables[table].footnotes, cbv)) << tables[table].id << cbv;
    EXPECT_EQ(tables[table].footnotes.front(), kPublishedProtocol);
  }
  for (const std::size_t table : {1U, 2U, 5U})
    EXPECT_TRUE(anyStartsWith(tables[table].footnotes, "PlanT: published: ")) << table;
  EXPECT_TRUE(anyStartsWith(collisionFigure().footnotes, "PlanT: published: "));
  const Table empty = fillTable(tables[1], {});
  EXPECT_NE(tablesMarkdown({empty}).find("\n- Pluto: published: 4.2 million"), std::string::npos);
  EXPECT_NE(batchPage("b", {}, {empty}, {}).find("Pluto: published: 4.2 million"),
            std::string::npos);
}

TEST(PaperFigures, HaveALineForEachCbvPlannerOfThePaper) {
  const std::vector<Figure> figures = paperFigures({});
  ASSERT_EQ(figures[0].id, "figure_3");
  ASSERT_EQ(figures[2].id, "figure_5");
  for (const char* planner : {"PPO", "Pluto", "RIFT"}) {
    const std::string line = std::string(planner) + ": not run";
    const auto& legend = figures[0].sheet.legend;
    EXPECT_TRUE(std::any_of(legend.begin(), legend.end(), [&](const auto& entry) {
      return entry.second == line;
    })) << line;
    EXPECT_TRUE(anyStartsWith(figures[2].sheet.notes, line)) << line;
    for (const std::size_t figure : {0U, 2U}) {
      EXPECT_TRUE(
          anyStartsWith(figures[figure].sheet.notes, std::string(planner) + ": published: "))
          << figures[figure].id << planner;
    }
  }
  EXPECT_TRUE(anyStartsWith(figures[0].sheet.notes,
                            "RIFT's repository prints of CBVs in CARLA: speed PPO 6.60 ± 4.03"));
}

}  // namespace
}  // namespace cdiff::evaluation
