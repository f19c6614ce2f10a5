// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "evaluation/run_plan.h"
#include "evaluation/run_record.h"
#include "evaluation/statistics.h"

namespace cdiff::evaluation {

// A table of the paper as data, and its cells as a batch fills them: per seed the mean over runs
// (weighted where the figure is a rate: the pooled rate), then mean and standard deviation over
// seeds, and the 95 % interval by routes (docs/statistics.md); events per km are all seeds' events
// over all their km, with an exact Poisson interval.

/// A figure that the paper prints as mean +- deviation.
struct PaperFigure {
  std::optional<double> mean;
  std::optional<double> deviation;
};

/// A column of a table of the paper: which value of a run's summary.json it shows, and over which
/// runs.
struct TableColumn {
  std::string name;  ///< the paper's
  std::string unit;
  std::string key;     ///< JSON pointer in a run's summary.json; "{}" stands for the row's subject
  std::string weight;  ///< pointer likewise: weight of a run within its seed; empty: all alike
  std::string rift_key;    ///< the figure by RIFT's definition; empty: it has none
  Factors levels;          ///< that runs of this column have besides those of the row
  std::string panel = {};  ///< title of the picture in which a figure shows it
};

/// A row of a table of the paper: the runs it covers and the values that the paper prints for them.
struct TableRow {
  std::string name;  ///< the paper's
  Factors levels;
  std::vector<PaperFigure> paper;  ///< by column; missing ones were not printed
  std::string subject;
  std::vector<PaperFigure> repository = {};  ///< likewise: as RIFT's repository prints them
};

/// A table of the paper before it is filled: title, columns and rows.
struct TableDefinition {
  std::string id;     ///< "table_1", also the name of its file
  std::string title;  ///< "Table 1. ..."
  std::string note;   ///< how the rows are read here where the paper leaves it open
  std::string heading;
  std::vector<TableColumn> columns;
  std::vector<TableRow> rows;
  std::vector<std::string> footnotes = {};  ///< what differs in protocol and training
};

/// How the runs behind rows or columns of a table worked.
struct TableSettings {
  std::vector<std::string> rows;  ///< names of rows that have runs with these settings
  std::string text;               ///< see settingsOf
};

/// A cell of a filled table: the paper's value beside ours, and on how many runs ours is based.
struct TableCell {
  PaperFigure paper;
  PaperFigure repository;             ///< RIFT's
  Statistics seeds;                   ///< over seeds that have the figure
  Statistics rift;                    ///< the same by RIFT's definition; n = 0 where it has none
  std::size_t routes = 0;             ///< of the runs that have the measure
  std::optional<std::size_t> events;  ///< of events per km
  double kilometers = 0.0;            ///< for these events
  std::size_t runs = 0;               ///< runs at these levels, however they ended
  std::size_t failed = 0;             ///< those of them that broke
  std::size_t missing = 0;            ///< those of them that were interrupted or not run
  std::size_t used = 0;               ///< those of them that have the measure
  std::size_t rift_routes = 0;        ///< routes of the runs that have it by RIFT's definition
  std::size_t rift_used = 0;          ///< how many those are
  std::string note;                   ///< why it is empty: not run, ...
};

/// A table of the paper, filled from the runs of a batch.
struct Table {
  TableDefinition definition;
  std::vector<TableSettings> settings;        ///< of complete runs, in the order of the rows
  std::vector<std::vector<TableCell>> cells;  ///< by row and column
};

/// Note of a cell whose runs all lack the measure.
inline constexpr const char* kNoRunHasIt = "no run has this measure";

Table fillTable(const TableDefinition& definition, const std::vector<BatchRun>& runs);

/// Whether a row shows its intervals: each of its values is based on kLeastRoutes routes or more.
bool showsIntervals(const std::vector<TableCell>& row);
/// Whether any row shows its intervals.
bool anyIntervals(const Table& table);
/// Whether a row with values shows none.
bool anyRowWithout(const Table& table);

/// Why nothing stands where runs with these levels would: "not implemented" (no such planner), "not
/// applicable in mode M" (the batch ran them in other modes alone, here M), "not run", "no run
/// completed", or `otherwise`.
std::string emptyReason(const Factors& levels, const std::vector<BatchRun>& runs,
                        const std::string& otherwise);

/// A line per row, column and definition (clean, rift_compat).
std::string tableCsv(const Table& table);

/// Notes the settings of the row's complete runs.
void addSettings(const TableRow& row, const TableDefinition& definition,
                 const std::vector<BatchRun>& runs, Table& table);

/// A line per entry of Table::settings.
std::vector<std::string> settingsLines(const Table& table);

/// "2.79 ± 0.10 [2.54, 3.04] (10 routes, 3 seeds, 30 runs)", with "7 / 1.520 km = " before events
/// per km; or the note in parentheses.
std::string cellText(const TableCell& cell, bool with_interval);
std::string paperText(const PaperFigure& figure);
/// What RIFT's definition gives, or empty.
std::string riftText(const TableCell& cell, bool with_interval);

}  // namespace cdiff::evaluation
