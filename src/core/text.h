// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cdiff::core {

// Numbers and names as text: shortest round-trip decimals, nearest known name, numbers from text.

/// Shortest decimal that reads back to the same double; "nan", "inf" and "-inf" for the rest.
std::string formatNumber(double value);

/// `value` with a fixed number of decimals, for people.
std::string formatFixed(double value, int decimals);

/// The whole text as a finite double; nullopt when anything else is in it.
std::optional<double> parseNumber(std::string_view text);

/// The known name with the smallest edit distance to `name`; empty when `known` is empty.
std::string nearestName(const std::string& name, const std::vector<std::string>& known);

/// Like nearestName, but empty unless at most a third of the letters differ or the known name
/// contains `name`: close enough to suggest.
std::string closeName(const std::string& name, const std::vector<std::string>& known);

/// "; did you mean 'NAME'?" with the close name; empty when there is none.
std::string didYouMean(const std::string& name, const std::vector<std::string>& known);

/// `text` cut to at most `length` bytes; "..." follows where it was longer. For quotes in messages.
std::string shortened(const std::string& text, std::size_t length = 80);

/// `text` with every character that is not a letter, digit, '_', '-' or '.' replaced by '_', and
/// without leading dots: safe as a file name.
std::string fileName(std::string text);

/// Parts of `text` between separators; runs of separators count as one, no empty parts.
std::vector<std::string> splitText(std::string_view text, char separator);

/// Whether `text` ends with `end`.
bool endsWith(std::string_view text, std::string_view end);

/// The parts with a separator between them.
std::string joinText(const std::vector<std::string>& parts, std::string_view separator);

// The local time of the wall clock as text, to the second.

/// For people: "2026-01-31 14:05:09".
std::string timeText();

/// For the name of a file or folder: "20260131_140509".
std::string timeForFileName();

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
