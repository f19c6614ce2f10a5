// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/statistics.h"

#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <numeric>

namespace cdiff::evaluation {

Statistics statisticsOf(const std::vector<double>& samples) {
  Statistics result;
  result.n = samples.size();
  if (samples.empty()) return result;
  const auto n = static_cast<double>(samples.size());
  const double mean = std::accumulate(samples.begin(), samples.end(), 0.0) / n;
  result.mean = mean;
  if (samples.size() < 2) return result;
  double squares = 0.0;
  for (const double sample : samples) squares += (sample - mean) * (sample - mean);
  const double deviation = std::sqrt(squares / (n - 1.0));
  const double t = boost::math::quantile(boost::math::students_t(n - 1.0), 0.975);
  result.standard_deviation = deviation;
  result.half_width = t * deviation / std::sqrt(n);
  return result;
}

namespace {

/// Values of one measure in a cell, by seed.
using ValuesBySeed = std::map<std::string, std::vector<double>>;

Statistics meanOverSeeds(const ValuesBySeed& values) {
  std::vector<double> means;
  for (const auto& [seed, samples] : values) {
    means.push_back(std::accumulate(samples.begin(), samples.end(), 0.0) /
                    static_cast<double>(samples.size()));
  }
  return statisticsOf(means);
}

Cell cellOfGroup(const Factors& factors, const std::vector<const RunRecord*>& records) {
  Cell cell;
  cell.factors = factors;
  std::map<std::string, ValuesBySeed> values;
  for (const RunRecord* record : records) {
    ++cell.runs;
    cell.failed += record->failed();
    cell.missing += !record->failed() && !record->complete();
    for (const auto& [name, value] : record->measures) {
      values[name][record->factors.at("seed")].push_back(value);
    }
  }
  for (const auto& [name, by_seed] : values) cell.measures[name] = meanOverSeeds(by_seed);
  return cell;
}

}  // namespace

std::vector<Cell> cellsOf(const std::vector<RunRecord>& records) {
  std::vector<Factors> order;
  std::map<Factors, std::vector<const RunRecord*>> groups;
  for (const RunRecord& record : records) {
    Factors factors = record.factors;
    factors.erase("seed");
    factors.erase("repetition");
    auto& group = groups[factors];
    if (group.empty()) order.push_back(factors);
    group.push_back(&record);
  }
  std::vector<Cell> cells;
  for (const Factors& factors : order) cells.push_back(cellOfGroup(factors, groups.at(factors)));
  return cells;
}

}  // namespace cdiff::evaluation
