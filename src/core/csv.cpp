// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/csv.h"

#include "core/text.h"

namespace cdiff::core {
namespace {

constexpr char kMark = '\'';

/// Whether a spreadsheet would compute the text: what starts with = + - @, a tab or a line end and
/// is not a number. Marks before that count too, so that texts read back as they were.
bool isFormula(const std::string& text) {
  const std::size_t first = text.find_first_not_of(kMark);
  if (first == std::string::npos) return false;
  const bool operation = std::string_view("=+-@\t\r\n").find(text[first]) != std::string_view::npos;
  return operation && text != "-inf" && (first > 0 || !parseNumber(text));
}

}  // namespace

std::string csvCell(const std::string& text) {
  const std::string shown = isFormula(text) ? kMark + text : text;
  if (shown.find_first_of(",\"\n\r") == std::string::npos) return shown;
  std::string quoted = "\"";
  for (const char letter : shown) quoted += letter == '"' ? "\"\"" : std::string(1, letter);
  return quoted + "\"";
}

std::string csvNumber(const std::optional<double>& value) {
  return value ? formatNumber(*value) : "";
}

std::string csvRow(const std::vector<std::string>& cells) {
  std::string row;
  for (std::size_t i = 0; i < cells.size(); ++i) row += (i > 0 ? "," : "") + csvCell(cells[i]);
  return row + "\n";
}

std::vector<std::string> csvCells(std::string_view row) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < row.size(); ++i) {
    const char letter = row[i];
    const bool doubled = quoted && letter == '"' && i + 1 < row.size() && row[i + 1] == '"';
    if (doubled) ++i;
    if (letter == '"' && !doubled) {
      quoted = !quoted;
    } else if (letter == ',' && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += letter;
    }
  }
  for (std::string& cell : cells) {
    if (!cell.empty() && cell.front() == kMark && isFormula(cell)) cell.erase(0, 1);
  }
  return cells;
}

std::vector<CsvRow> csvRows(std::string_view text) {
  std::vector<CsvRow> rows;
  std::size_t line = 1;
  std::size_t first = 1;  // line of the row
  std::size_t begin = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '"') quoted = !quoted;
    if (text[i] != '\n') continue;
    ++line;
    if (quoted) continue;
    rows.push_back({text.substr(begin, i - begin), first, true});
    begin = i + 1;
    first = line;
  }
  if (begin < text.size()) rows.push_back({text.substr(begin), first, false});
  return rows;
}

}  // namespace cdiff::core
