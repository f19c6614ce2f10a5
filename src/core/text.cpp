// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <ctime>
#include <numeric>

namespace cdiff::core {
namespace {

std::size_t editDistance(const std::string& left, const std::string& right) {
  std::vector<std::size_t> row(right.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= left.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= right.size(); ++j) {
      const std::size_t above = row[j];
      const std::size_t change = diagonal + (left[i - 1] == right[j - 1] ? 0 : 1);
      row[j] = std::min({above + 1, row[j - 1] + 1, change});
      diagonal = above;
    }
  }
  return row.back();
}

std::string now(const char* format) {
  const std::time_t time = std::time(nullptr);
  std::tm local{};
  ::localtime_r(&time, &local);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), format, &local);
  return text.data();
}

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

std::string formatNumber(double value) {
  std::array<char, 32> buffer{};
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return std::string(buffer.data(), result.ptr);
}

std::string formatFixed(double value, int decimals) {
  std::array<char, 400> buffer{};
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                    std::chars_format::fixed, decimals);
  return std::string(buffer.data(), result.ptr);
}

std::optional<double> parseNumber(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double value = 0.0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ec != std::errc() || result.ptr != text.data() + text.size()) return std::nullopt;
  if (!std::isfinite(value)) return std::nullopt;
  return value;
}

std::string nearestName(const std::string& name, const std::vector<std::string>& known) {
  if (known.empty()) return {};
  return *std::min_element(known.begin(), known.end(), [&](const auto& left, const auto& right) {
    return editDistance(name, left) < editDistance(name, right);
  });
}

std::string closeName(const std::string& name, const std::vector<std::string>& known) {
  constexpr std::size_t kLeastPart = 3;  // letters
  const std::string nearest = nearestName(name, known);
  if (3 * editDistance(name, nearest) <= std::max(name.size(), nearest.size())) return nearest;
  if (name.size() < kLeastPart) return {};
  const auto containing = std::find_if(known.begin(), known.end(), [&](const std::string& text) {
    return text.find(name) != std::string::npos;
  });
  return containing == known.end() ? std::string() : *containing;
}

std::string didYouMean(const std::string& name, const std::vector<std::string>& known) {
  const std::string close = closeName(name, known);
  return close.empty() ? close : "; did you mean '" + close + "'?";
}

std::string shortened(const std::string& text, std::size_t length) {
  return text.size() <= length ? text : text.substr(0, length) + "...";
}

std::string fileName(std::string text) {
  for (char& letter : text) {
    const bool plain = (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
                       (letter >= '0' && letter <= '9') || letter == '_' || letter == '-' ||
                       letter == '.';
    if (!plain) letter = '_';
  }
  text.erase(0, text.find_first_not_of('.'));
  return text.empty() ? "unnamed" : text;
}

std::vector<std::string> splitText(std::string_view text, char separator) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    if (end > begin) parts.emplace_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

bool endsWith(std::string_view text, std::string_view end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

std::string joinText(const std::vector<std::string>& parts, std::string_view separator) {
  std::string joined;
  for (const std::string& part : parts) {
    if (!joined.empty()) joined += separator;
    joined += part;
  }
  return joined;
}

std::string timeText() { return now("%Y-%m-%d %H:%M:%S"); }

std::string timeForFileName() { return now("%Y%m%d_%H%M%S"); }

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
