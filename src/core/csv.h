// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cdiff::core {

// Rows of comma-separated values as in RFC 4180: cells are quoted only where they must be. A text
// that a spreadsheet would evaluate as a formula (it starts with = + - @, a tab or a line end and
// is not a number) is prefixed with an apostrophe, which reading removes.

/// `text` as one cell.
std::string csvCell(const std::string& text);

/// A number as one cell, empty where there is none.
std::string csvNumber(const std::optional<double>& value);

/// The cells as one row with its line end.
std::string csvRow(const std::vector<std::string>& cells);

/// Cells of a row, including empty ones; `row` has no line end.
std::vector<std::string> csvCells(std::string_view row);

/// A row in the text of a file.
struct CsvRow {
  std::string_view text;  ///< without its line end; line ends in quoted cells are part of it
  std::size_t line = 1;   ///< in which it starts
  bool ended = false;     ///< whether a line end follows; false for a row that was cut off
};

/// All rows of a text, which must outlive them; no row follows the last line end.
std::vector<CsvRow> csvRows(std::string_view text);

}  // namespace cdiff::core
