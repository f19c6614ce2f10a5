// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/batch_report.h"

#include <set>

#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/paper/paper_definitions.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;

void makeFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    throw core::InputError("cannot make the folder '" + folder.string() + "': " + error.message());
  }
  core::removeTemporaries(folder);
}

/// Tables and figures pool runs over scenarios and seeds, never over variants: of several, the runs
/// without one count, else those of the first.
std::vector<BatchRun> ofOneVariant(const std::vector<BatchRun>& runs) {
  std::set<std::string> variants;
  for (const BatchRun& run : runs) variants.insert(run.record.factors.at("variant"));
  std::vector<BatchRun> kept;
  for (const BatchRun& run : runs) {
    if (run.record.factors.at("variant") == *variants.begin()) kept.push_back(run);
  }
  return kept;
}

std::string row(const std::vector<std::string>& cells) {
  return "| " + core::joinText(cells, " | ") + " |\n";
}

std::string markdownCell(const TableCell& cell) {
  const std::string rift = riftText(cell);
  const std::string paper = paperText(cell.paper);
  return cellText(cell) + (rift.empty() ? "" : "<br>RIFT: " + rift) +
         (paper.empty() ? "" : "<br>paper: " + paper);
}

}  // namespace

std::string tablesMarkdown(const std::vector<Table>& tables) {
  std::string text =
      "# Tables of the paper\n\nOurs: mean ± standard deviation over seeds [95 % interval, "
      "bootstrap "
      "by routes; of events per km exact Poisson] (routes, seeds, runs that have the measure). "
      "RIFT: the same by RIFT's definition. paper: as printed there. "
      "In parentheses alone: why a cell is empty.\n";
  for (const Table& table : tables) {
    const TableDefinition& definition = table.definition;
    text += "\n## " + definition.title + "\n\n";
    if (!definition.note.empty()) text += definition.note + "\n\n";
    std::vector<std::string> head = {definition.heading};
    for (const TableColumn& column : definition.columns)
      head.push_back(column.name + (column.unit.empty() ? "" : " [" + column.unit + "]"));
    text += row(head) + row(std::vector<std::string>(head.size(), "---"));
    for (std::size_t i = 0; i < table.cells.size(); ++i) {
      std::vector<std::string> cells = {definition.rows[i].name};
      for (const TableCell& cell : table.cells[i]) cells.push_back(markdownCell(cell));
      text += row(cells);
    }
    text += "\n";
    for (const std::string& line : settingsLines(table)) text += "- " + line + "\n";
  }
  return text;
}

void writeBatchReport(const fs::path& results, const std::string& name) {
  const std::vector<BatchRun> runs = readBatchRuns(results);
  const std::vector<BatchRun> pooled = ofOneVariant(runs);
  std::vector<Table> tables;
  for (const TableDefinition& definition : paperTables())
    tables.push_back(fillTable(definition, pooled));
  const std::vector<Figure> figures = paperFigures(pooled);
  makeFolder(results / "tables");
  for (const Table& table : tables) {
    core::writeFileAtomically(results / "tables" / (table.definition.id + ".csv"), tableCsv(table));
  }
  core::writeFileAtomically(results / "tables" / "tables.md", tablesMarkdown(tables));
  makeFolder(results / "figures");
  for (const Figure& figure : figures) {
    core::writeFileAtomically(results / "figures" / (figure.id + ".csv"), figure.csv);
    core::writeFileAtomically(results / "figures" / (figure.id + ".svg"),
                              page::sheetFile(figure.sheet));
  }
  core::writeFileAtomically(results / "index.html", batchPage(name, runs, tables, figures));
}

}  // namespace cdiff::evaluation
