// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/metric_file.h"

#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/file.h"
#include "core/spelling.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "metrics/formulas/distributions.h"
#include "metrics/formulas/ttc_2d.h"

namespace cdiff::record {
namespace {

using Json = nlohmann::json;
using Columns = std::map<std::string, std::size_t>;

/// Cells between commas, empty ones included, line end and spaces cut off.
std::vector<std::string> cellsOf(const std::string& line) {
  std::vector<std::string> cells;
  std::stringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) {
    const auto begin = cell.find_first_not_of(" \t\r");
    const auto end = cell.find_last_not_of(" \t\r");
    cells.push_back(begin == std::string::npos ? "" : cell.substr(begin, end - begin + 1));
  }
  return cells;
}

/// One line of a table with a header.
class Row {
 public:
  Row(const Columns& columns, std::vector<std::string> cells, std::string place)
      : columns_(columns), cells_(std::move(cells)), place_(std::move(place)) {}

  double number(const std::string& column) const {
    const auto found = columns_.find(column);
    if (found == columns_.end()) throw core::InputError(place_ + ": no column " + column);
    const std::string text = found->second < cells_.size() ? cells_[found->second] : "";
    const auto value = core::parseNumber(text);
    if (!value) {
      throw core::InputError(place_ + ": column " + column + " is \"" + text +
                             "\", expected a finite number");
    }
    return *value;
  }
  /// A length, above 0.
  double size(const std::string& column) const {
    const double value = number(column);
    if (!(value > 0.0)) refuse(column, "a size above 0");
    return value;
  }
  [[noreturn]] void refuse(const std::string& column, const std::string& expected) const {
    throw core::InputError(place_ + ": column " + column + " is \"" + cells_[columns_.at(column)] +
                           "\", expected " + expected);
  }

 private:
  const Columns& columns_;
  std::vector<std::string> cells_;
  std::string place_;
};

metrics::MovingBox boxOfRow(const Row& row, const std::string& suffix) {
  metrics::MovingBox moving;
  moving.box.center = {row.number("x" + suffix), row.number("y" + suffix)};
  const Eigen::Vector2d forward{row.number("hx" + suffix), row.number("hy" + suffix)};
  if (forward.norm() == 0.0) row.refuse("hx" + suffix, "a direction; hx and hy are both 0");
  moving.box.heading = std::atan2(forward.y(), forward.x());
  moving.box.length = row.size("length" + suffix);
  moving.box.width = row.size("width" + suffix);
  moving.velocity = {row.number("vx" + suffix), row.number("vy" + suffix)};
  return moving;
}

std::vector<std::string> evaluatePairs(const std::string& file) {
  std::stringstream stream(core::readFile(file, "file of box pairs"));
  std::string line;
  std::getline(stream, line);
  Columns columns;
  const std::vector<std::string> names = cellsOf(line);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!columns.emplace(names[i], i).second)
      throw core::InputError(file + ":1: two columns are called '" + names[i] + "'");
  }
  std::vector<std::string> results;
  for (std::size_t line_number = 2; std::getline(stream, line); ++line_number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const Row row(columns, cellsOf(line), file + ":" + std::to_string(line_number));
    const metrics::MovingBox first = boxOfRow(row, "_i");
    const auto time = metrics::timeToCollision2d(first, boxOfRow(row, "_j"));
    results.push_back(std::to_string(results.size() + 1) + ": " +
                      (time ? core::formatNumber(*time) : "inf"));
  }
  if (results.empty()) throw core::InputError(file + ": expected a header and at least one line");
  return results;
}

std::vector<double> samplesOf(const Json& entry, const char* key, const std::string& place) {
  const auto found = entry.find(key);
  if (found == entry.end() || !found->is_array()) {
    throw core::InputError(place + ": expected a list \"" + key + "\"");
  }
  std::vector<double> samples;
  for (const Json& value : *found) {
    if (!value.is_number()) {
      throw core::InputError(place + ": \"" + key + "\" holds " + value.dump() +
                             ", expected numbers");
    }
    samples.push_back(value.get<double>());
  }
  return samples;
}

std::string shapiroWilkLine(const Json& entry, const std::string& place) {
  const std::vector<double> samples = samplesOf(entry, "x", place);
  const auto kind = entry.find("kind");
  std::string line = "(";
  if (kind != entry.end() && kind->is_string()) line += kind->get<std::string>() + ", ";
  line += "n = " + std::to_string(samples.size()) + "): ";
  const metrics::ShapiroWilk test = metrics::shapiroWilk(samples);
  if (!test.w) return line + "none, " + test.reason;
  return line + "W = " + core::formatNumber(*test.w) + ", p = " + core::formatNumber(*test.p);
}

std::string wassersteinLine(const Json& entry, const std::string& place) {
  const std::vector<double> first = samplesOf(entry, "a", place);
  const std::vector<double> second = samplesOf(entry, "b", place);
  const std::string sizes = std::to_string(first.size()) + ", " + std::to_string(second.size());
  const auto distance = metrics::wassersteinDistance(first, second);
  return "(n = " + sizes +
         "): " + (distance ? core::formatNumber(*distance) : "none, a sample is empty");
}

using CaseLine = std::function<std::string(const Json&, const std::string&)>;

std::vector<std::string> evaluateCases(const std::string& file, const CaseLine& case_line) {
  Json document;
  try {
    document = Json::parse(core::readFile(file, "file of samples"));
  } catch (const Json::exception& error) {
    throw core::InputError(file + ": not JSON: " + error.what());
  }
  const auto cases = document.find("cases");
  if (cases == document.end() || !cases->is_array() || cases->empty()) {
    throw core::InputError(file + ": expected an object with a list \"cases\" that is not empty");
  }
  std::vector<std::string> results;
  for (const Json& entry : *cases) {
    const std::string number = std::to_string(results.size() + 1);
    if (!entry.is_object()) throw core::InputError(file + ": case " + number + " is not an object");
    results.push_back(number + " " + case_line(entry, file + ": case " + number));
  }
  return results;
}

}  // namespace

std::vector<std::string> evaluateMetricFile(const std::string& metric, const std::string& file) {
  if (metric == "ttc_2d") return evaluatePairs(file);
  if (metric == "shapiro_wilk") return evaluateCases(file, shapiroWilkLine);
  if (metric == "wasserstein") return evaluateCases(file, wassersteinLine);
  throw core::InputError("unknown metric \"" + metric +
                         "\", expected ttc_2d, shapiro_wilk or wasserstein; nearest: " +
                         core::nearestName(metric, {"ttc_2d", "shapiro_wilk", "wasserstein"}));
}

}  // namespace cdiff::record
